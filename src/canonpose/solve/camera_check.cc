#include "canonpose/solve/camera_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "canonpose/base/median.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/time_jump_correction.h"
#include "canonpose/solve/time_offset.h"
#include "canonpose/solve/view_examination.h"
#include "canonpose/solve/view_signs.h"

namespace canonpose {
namespace {

constexpr int kOffsetRounds = 3;
constexpr int kExaminationRounds = 3;
/// A subset of views is taken for right if their median error is below this, in body units, and, per degree of freedom,
/// below these multiples of the error of every other subset of that size and of the error with all views, which were
/// calibrated less quickly. Measured: 0.25 to 0.6 % usually, 0.7 to 6 % with a view of somebody else.
constexpr double kAgreement = 0.015;
constexpr double kAgreementGain = 0.85;
constexpr double kGainOnAll = 0.93;
/// Instead of kAgreementGain where it is known what is wrong with the view that the subset leaves out.
constexpr double kGainOfKnownFault = 0.95;
/// The same of a pair, which explains nearly anything.
constexpr double kPairGain = 0.6;
/// Two views at half the frame rate are believed if the error falls below this multiple of that with all views as they
/// are, and kAgreementGain times that of any other two.
constexpr double kSlowPairGain = 0.85;
/// A view that was corrected and still has so many outliers was misread: it shows something else, parts of which fit.
/// Views at half the frame rate, rightly read, have up to 20 %.
constexpr double kMisreadOutliers = 0.3;
/// Of CappedError().
constexpr double kLargeError = 0.03;
/// Pairs of views are tried up to this many.
constexpr std::size_t kMaxPairs = 15;

/// Why a view is left out as a whole.
struct Rejection {
  const char* kind;  ///< CameraFinding::kind
  const char* why;   ///< in words that follow the camera's name
};
constexpr Rejection kNotTheSame = {"does-not-fit", "does not show the same person, or not at the same time"};
constexpr Rejection kBackwards = {"backwards", "runs backwards"};
constexpr Rejection kOtherSides = {"sides-exchanged",
                                   "fits only with left and right exchanged: its image is mirrored, or its joints "
                                   "are, and moving cameras do not show which"};

/// Shifts views of a clip in time, always the one that gains most, until all fit. Returns whether any view was shifted.
bool AlignClip(CaptureObservations& capture, const Solution& solution, int clip,
               std::vector<ViewCorrection>& corrections) {
  // Of two views either could be shifted; we take the second.
  std::vector<int> views = solution.estimate.ValidViews(0);
  if (views.size() == 2) views.erase(views.begin());
  bool moved = false;
  for (int round = 0; round < 2 * capture.view_count(); ++round) {
    OffsetEstimate best;
    int best_view = -1;
    for (const int v : views) {
      const ViewCorrection& correction = corrections[static_cast<std::size_t>(v)];
      const bool was_moved = correction.offset_frames != 0 || correction.reading.time.offset != 0.0;
      const OffsetEstimate found = EstimateOffset(capture, solution, clip, v, was_moved);
      if (found.gain <= best.gain) continue;
      best = found;
      best_view = v;
    }
    if (best_view < 0) break;
    ShiftView(capture, clip, best_view, best.frames);
    corrections[static_cast<std::size_t>(best_view)].offset_frames += best.frames;
    moved = true;
  }
  return moved;
}

void AlignCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution, CameraCheck& check) {
  for (int round = 0; round < kOffsetRounds; ++round) {
    bool moved = false;
    for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
      moved = AlignClip(capture, solution, static_cast<int>(clip), check.corrections[clip]) || moved;
    }
    if (!moved) return;
    solution = calibrate(capture);
    if (!solution.calibration_summary.IsUsable()) return;
  }
}

/// Shifts all views of a clip by the same number of frames so that most of them keep their own time.
void KeepMajority(CaptureObservations& capture, CameraCheck& check) {
  for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
    std::vector<ViewCorrection>& corrections = check.corrections[clip];
    std::vector<int> used;
    for (std::size_t v = 0; v < corrections.size(); ++v) {
      if (!check.dropped[v]) used.push_back(corrections[v].offset_frames);
    }
    int most = 0;
    for (const int offset : used) {
      if (std::ranges::count(used, offset) > std::ranges::count(used, most)) most = offset;
    }
    for (std::size_t v = 0; most != 0 && v < corrections.size(); ++v) {
      ShiftView(capture, static_cast<int>(clip), static_cast<int>(v), -most);
      corrections[v].offset_frames -= most;
    }
  }
}

/// Views that agree with each other, and the solution from them alone.
struct Consensus {
  std::vector<int> views;
  CaptureObservations capture;  ///< what they saw; nothing from the others
  Solution solution;
  double error = 0.0;             ///< MedianError()
  bool is_as_recorded = false;    ///< found from the views as they were recorded, before any was shifted
  std::vector<int> at_half_rate;  ///< of `views`: they agree once they are read at twice their frame rate
};

/// The candidate with the smallest error, and how far ahead of the next it is.
struct BestConsensus {
  std::optional<Consensus> consensus;
  double second_error = std::numeric_limits<double>::infinity();

  void Consider(Consensus candidate) {
    if (consensus && candidate.error >= consensus->error) {
      second_error = std::min(second_error, candidate.error);
      return;
    }
    if (consensus) second_error = consensus->error;
    consensus = std::move(candidate);
  }
};

/// An error of keypoints, given that each joint's three coordinates were fitted to two of each of these views.
double PerDegreeOfFreedom(double error, std::size_t views) {
  const double keypoints = 2.0 * static_cast<double>(views);
  return error / std::sqrt((keypoints - 3.0) / keypoints);
}

/// The solution from some views; nothing where they do not agree.
std::optional<Consensus> Agree(const CaptureObservations& capture, const Calibrate& calibrate,
                               const std::vector<int>& views) {
  Consensus consensus;
  consensus.views = views;
  consensus.capture = capture;
  for (int v = 0; v < capture.view_count(); ++v) {
    if (std::ranges::find(views, v) == views.end()) DropView(consensus.capture, v);
  }
  if (static_cast<int>(FramesWithStart(consensus.capture).size()) < kMinFrames) return std::nullopt;
  consensus.solution = calibrate(consensus.capture);
  if (!consensus.solution.calibration_summary.IsUsable()) return std::nullopt;
  const double error = MedianError(consensus.capture, consensus.solution);
  if (!(error < kAgreement)) return std::nullopt;
  consensus.error = PerDegreeOfFreedom(CappedError(consensus.capture, consensus.solution), views.size());
  const Plausibility plausibility = MeasurePlausibility(consensus.capture, consensus.solution);
  if (!Implausible(plausibility).empty() || !Doubtful(plausibility).empty()) return std::nullopt;
  return consensus;
}

class Examination {
 public:
  Examination(const CaptureObservations& original, const Calibrate& calibrate, const Calibrate& calibrate_quickly,
              CaptureObservations& capture, Solution& solution, CameraCheck& check)
      : original_(original),
        calibrate_(calibrate),
        calibrate_quickly_(calibrate_quickly),
        capture_(capture),
        solution_(solution),
        check_(check) {}

  /// Corrects or drops views that do not fit; whether anything was changed.
  bool Run();

 private:
  [[nodiscard]] std::optional<Consensus> FindConsensus(const std::vector<ViewSigns>& signs) const;
  // `with_all` is the error of all known views together, per degree of freedom.
  [[nodiscard]] std::optional<Consensus> ConsensusWithout(const std::vector<ViewSigns>& signs, double with_all) const;
  /// All of four views, two of which have half the frame rate of the others. Each two agree with each other, so that
  /// no view alone is found to be wrong, and where two stand opposite each other neither pair gives a solution.
  [[nodiscard]] std::optional<Consensus> ConsensusWithSlowPair(const std::vector<ViewSigns>& signs,
                                                               double with_all) const;
  [[nodiscard]] std::optional<Consensus> ConsensusOfPairs(const std::vector<ViewSigns>& signs, double with_all) const;
  /// The views that are known but not part of the consensus.
  [[nodiscard]] std::vector<int> Others(const Consensus& consensus, const std::vector<ViewSigns>& signs) const;
  /// Whether a view would fit the motion that the consensus shows if something that can be named were corrected.
  [[nodiscard]] bool HasKnownFault(const Consensus& consensus, int view) const;
  /// How many of the other views fit the motion that the consensus shows, as they are.
  [[nodiscard]] int CountFollowers(const Consensus& consensus, const std::vector<ViewSigns>& signs) const;
  /// How many of the other views fit it mirrored, at another time or at another rate.
  [[nodiscard]] int CountReadable(const Consensus& consensus, const std::vector<ViewSigns>& signs) const;
  /// The median log focal length of the views that agree.
  [[nodiscard]] double FocalOf(const Consensus& consensus, int clip) const;
  void Correct(const Consensus& consensus, int view);
  /// Drops, of the views that do not fit although they were corrected, the worst; whether there was any.
  bool DropMisread(const std::vector<ViewSigns>& signs);
  void Drop(int view, const Rejection& rejection);

  const CaptureObservations& original_;
  const Calibrate& calibrate_;
  const Calibrate& calibrate_quickly_;
  CaptureObservations& capture_;
  Solution& solution_;
  CameraCheck& check_;
  std::set<int> corrected_;                       ///< views that Correct() kept
  std::optional<CaptureObservations> looked_at_;  ///< by the last Run()
};

double Examination::FocalOf(const Consensus& consensus, int clip) const {
  std::vector<double> focals;
  for (const int v : consensus.views) {
    const int first = consensus.capture.clips[static_cast<std::size_t>(clip)].first;
    focals.push_back(consensus.solution.estimate.CameraAt(first, v).log_focal);
  }
  return Median(std::move(focals));
}

std::optional<Consensus> Examination::ConsensusWithout(const std::vector<ViewSigns>& signs, double with_all) const {
  const std::vector<int> known = KnownViews(signs);
  BestConsensus best;
  for (const int v : known) {
    std::vector<int> views = known;
    std::erase(views, v);
    if (std::optional<Consensus> candidate = Agree(capture_, calibrate_quickly_, views)) {
      best.Consider(*std::move(candidate));
    }
  }
  if (!best.consensus) return std::nullopt;
  const double error = best.consensus->error;
  if (error >= kGainOnAll * with_all || error >= kGainOfKnownFault * best.second_error) return std::nullopt;
  const bool is_clear = error < kAgreementGain * best.second_error;
  if (!is_clear && !HasKnownFault(*best.consensus, Others(*best.consensus, signs).front())) return std::nullopt;
  return std::move(best.consensus);
}

bool Examination::HasKnownFault(const Consensus& consensus, int view) const {
  for (int clip = 0; clip < static_cast<int>(capture_.clips.size()); ++clip) {
    const KnownMotion motion(consensus.capture, consensus.solution, clip);
    const ViewExamination found = ExamineView(original_, clip, view, motion, FocalOf(consensus, clip),
                                              consensus.solution.scales.observation.Typical());
    const bool has_named_stretch =
        std::ranges::any_of(found.bad, [](const BadStretch& bad) { return bad.fault != StretchFault::kOther; });
    if (found.fits && (!found.reading.IsIdentity() || has_named_stretch)) return true;
  }
  return false;
}

std::vector<int> Examination::Others(const Consensus& consensus, const std::vector<ViewSigns>& signs) const {
  std::vector<int> others = KnownViews(signs);
  std::erase_if(others, [&](int v) { return std::ranges::find(consensus.views, v) != consensus.views.end(); });
  return others;
}

int Examination::CountFollowers(const Consensus& consensus, const std::vector<ViewSigns>& signs) const {
  int followers = 0;
  const KnownMotion motion(consensus.capture, consensus.solution, 0);
  for (const int v : Others(consensus, signs)) {
    const double share =
        ShareThatFits(original_, 0, v, motion, FocalOf(consensus, 0), consensus.solution.scales.observation.Typical());
    followers += share > 0.9 ? 1 : 0;
  }
  return followers;
}

int Examination::CountReadable(const Consensus& consensus, const std::vector<ViewSigns>& signs) const {
  const KnownMotion motion(consensus.capture, consensus.solution, 0);
  const double scatter = consensus.solution.scales.observation.Typical();
  int readable = 0;
  for (const int v : Others(consensus, signs)) {
    const ViewExamination found = ExamineView(original_, 0, v, motion, FocalOf(consensus, 0), scatter);
    readable += found.fits && found.reading.time.rate > 0.0 ? 1 : 0;
  }
  return readable;
}

std::optional<Consensus> Examination::ConsensusWithSlowPair(const std::vector<ViewSigns>& signs,
                                                            double with_all) const {
  const std::vector<int> known = KnownViews(signs);
  if (known.size() != 4) return std::nullopt;
  ViewCorrection faster;
  faster.reading.time.rate = 2.0;
  BestConsensus best;
  for (const int v : known) {
    for (const int w : known) {
      if (w <= v) continue;
      CaptureObservations read = original_;
      for (int clip = 0; clip < static_cast<int>(read.clips.size()); ++clip) {
        for (const int view : {v, w}) ApplyCorrection(faster, clip, view, read);
      }
      std::optional<Consensus> candidate = Agree(read, calibrate_quickly_, known);
      if (!candidate) continue;
      candidate->is_as_recorded = true;
      candidate->at_half_rate = {v, w};
      best.Consider(*std::move(candidate));
    }
  }
  if (!best.consensus) return std::nullopt;
  const double error = best.consensus->error;
  if (error >= kSlowPairGain * with_all || error >= kAgreementGain * best.second_error) return std::nullopt;
  return std::move(best.consensus);
}

std::optional<Consensus> Examination::ConsensusOfPairs(const std::vector<ViewSigns>& signs, double with_all) const {
  std::vector<Consensus> candidates;
  int most = 0;
  std::size_t tried = 0;
  for (int v = 0; v < capture_.view_count(); ++v) {
    for (int w = v + 1; w < capture_.view_count() && tried < kMaxPairs; ++w) {
      if (!signs[static_cast<std::size_t>(v)].known || !signs[static_cast<std::size_t>(w)].known) continue;
      ++tried;
      std::optional<Consensus> candidate = Agree(original_, calibrate_quickly_, {v, w});
      if (!candidate || candidate->error > kPairGain * with_all) continue;
      const int followers = CountFollowers(*candidate, signs);
      if (followers < most) continue;
      if (followers > most) candidates.clear();
      most = followers;
      candidate->is_as_recorded = true;
      candidates.push_back(*std::move(candidate));
    }
  }
  if (candidates.empty()) return std::nullopt;
  // Two of four cameras at half the rate agree with each other as well as the other two do. The rest can be read
  // against either pair, but the slow one, fast-forwarded, ends in the middle of the clip.
  std::vector<std::tuple<int, int, double>> ranks;
  for (const Consensus& pair : candidates) {
    const int readable = most == 0 && candidates.size() > 1 ? CountReadable(pair, signs) : 0;
    const int frames = static_cast<int>(FramesWithStart(pair.capture).size());
    ranks.emplace_back(readable, 10 * frames / capture_.frame_count, -pair.error);
  }
  const auto best = std::ranges::max_element(ranks) - ranks.begin();
  return std::move(candidates[static_cast<std::size_t>(best)]);
}

std::optional<Consensus> Examination::FindConsensus(const std::vector<ViewSigns>& signs) const {
  const std::size_t known = KnownViews(signs).size();
  if (known < 3) return std::nullopt;
  const double with_all = PerDegreeOfFreedom(CappedError(capture_, solution_), known);
  std::optional<Consensus> consensus = ConsensusWithout(signs, with_all);
  std::optional<Consensus> with_slow_pair = ConsensusWithSlowPair(signs, with_all);
  if (with_slow_pair && (!consensus || with_slow_pair->error < consensus->error)) consensus = std::move(with_slow_pair);
  if (!consensus && known > 3) consensus = ConsensusOfPairs(signs, with_all);
  return consensus;
}

void Examination::Correct(const Consensus& consensus, int view) {
  CopyView(original_, view, capture_);
  int clips_that_fit = 0;
  Rejection rejection = kNotTheSame;
  for (int clip = 0; clip < static_cast<int>(capture_.clips.size()); ++clip) {
    // The view is examined as it was recorded, not as it was shifted against a solution that it took part in.
    const KnownMotion motion(consensus.capture, consensus.solution, clip);
    ViewExamination found = ExamineView(original_, clip, view, motion, FocalOf(consensus, clip),
                                        consensus.solution.scales.observation.Typical());
    ViewCorrection& correction = check_.At(clip, view);
    correction = {};
    const int frames = capture_.clips[static_cast<std::size_t>(clip)].count;
    if (found.fits && found.reading.time.rate < 0.0) {
      // Another take of the same motion cannot be told from a recording that runs backwards; it is no evidence.
      found.fits = false;
      rejection = kBackwards;
    }
    const bool has_other_sides = found.reading.is_mirrored || found.reading.sides_are_exchanged;
    if (found.fits && has_other_sides && !capture_.static_cameras) {
      found.fits = false;
      rejection = kOtherSides;
    }
    if (found.fits) {
      ++clips_that_fit;
      correction.reading = found.reading;
      correction.bad = found.bad;
    } else {
      correction.bad = {{0, frames}};
    }
    ApplyCorrection(correction, clip, view, capture_);
  }
  if (clips_that_fit > 0) {
    corrected_.insert(view);
  } else {
    Drop(view, rejection);
  }
}

void Examination::Drop(int view, const Rejection& rejection) {
  DropView(capture_, view);
  check_.dropped[static_cast<std::size_t>(view)] = true;
  check_.why_dropped[static_cast<std::size_t>(view)] = rejection.why;
  check_.dropped_as[static_cast<std::size_t>(view)] = rejection.kind;
  for (std::vector<ViewCorrection>& corrections : check_.corrections) corrections[static_cast<std::size_t>(view)] = {};
}

bool Examination::DropMisread(const std::vector<ViewSigns>& signs) {
  if (KnownViews(signs).size() < 3) return false;
  int worst = -1;
  for (const int v : corrected_) {
    const ViewSigns& view = signs[static_cast<std::size_t>(v)];
    if (!view.known || view.outliers < kMisreadOutliers) continue;
    if (worst < 0 || view.outliers > signs[static_cast<std::size_t>(worst)].outliers) worst = v;
  }
  if (worst >= 0) Drop(worst, kNotTheSame);
  return worst >= 0;
}

bool Examination::Run() {
  if (looked_at_ && HasSameKeypoints(*looked_at_, capture_)) return false;
  looked_at_ = capture_;
  const std::vector<ViewSigns> signs = MeasureSigns(capture_, solution_);
  if (DropMisread(signs)) {
    solution_ = calibrate_(capture_);
    return true;
  }
  if (!AnyAlarm(signs) && Doubtful(MeasurePlausibility(capture_, solution_)).empty()) return false;
  const std::optional<Consensus> consensus = FindConsensus(signs);
  if (!consensus) return false;
  const CaptureObservations before = capture_;
  for (const int v : consensus->views) {
    if (!consensus->is_as_recorded) continue;
    corrected_.erase(v);
    CopyView(original_, v, capture_);
    for (std::vector<ViewCorrection>& corrections : check_.corrections) corrections[static_cast<std::size_t>(v)] = {};
  }
  for (const int v : consensus->at_half_rate) {
    for (int clip = 0; clip < static_cast<int>(capture_.clips.size()); ++clip) {
      check_.At(clip, v).reading.time.rate = 2.0;
      ApplyCorrection(check_.At(clip, v), clip, v, capture_);
    }
  }
  for (const int v : Others(*consensus, signs)) {
    // Moving cameras follow nearly anything. A view that does not fit although it was corrected shows something else.
    if (corrected_.contains(v)) {
      Drop(v, kNotTheSame);
    } else {
      Correct(*consensus, v);
    }
  }
  if (HasSameKeypoints(capture_, before)) {
    // Nothing was found in the other views that could be corrected; but without them the rest agrees far better.
    const std::vector<int> others = Others(*consensus, signs);
    if (others.empty()) return false;
    for (const int v : others) Drop(v, kNotTheSame);
  }
  solution_ = calibrate_(capture_);
  return true;
}

}  // namespace

void ShiftView(CaptureObservations& capture, int clip, int view, int frames) {
  ViewCorrection shift;
  shift.offset_frames = frames;
  ApplyCorrection(shift, clip, view, capture);
}

void DropView(CaptureObservations& capture, int view) { DropFrames(view, 0, capture.frame_count, capture); }

double MedianError(const CaptureObservations& capture, const Solution& solution) {
  std::vector<double> errors;
  VisitErrors(capture, ConsecutiveFrames(0, capture.frame_count), solution.estimate,
              [&](int, int, int, double error) { errors.push_back(error); });
  return Median(std::move(errors));
}

double CappedError(const CaptureObservations& capture, const Solution& solution) {
  double sum = 0.0;
  std::int64_t count = 0;
  VisitErrors(capture, ConsecutiveFrames(0, capture.frame_count), solution.estimate, [&](int, int, int, double error) {
    sum += std::min(error, kLargeError);
    ++count;
  });
  return count > 0 ? sum / static_cast<double>(count) : std::nan("");
}

bool FitsBetter(const CaptureObservations& capture, const Solution& solution, const Solution& other, double gain) {
  if (!solution.calibration_summary.IsUsable()) return false;
  return !other.calibration_summary.IsUsable() || CappedError(capture, solution) < gain * CappedError(capture, other);
}

CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, const Calibrate& calibrate_quickly,
                         Solution& solution) {
  CameraCheck check(capture);
  const CaptureObservations original = capture;
  Examination examination(original, calibrate, calibrate_quickly, capture, solution, check);
  // What is clearly wrong comes first: shifts found against a solution that it has spoilt would be wrong, too.
  examination.Run();
  for (int round = 0; round < kExaminationRounds && solution.calibration_summary.IsUsable(); ++round) {
    bool changed = false;
    if (capture.static_cameras) {
      AlignCameras(capture, calibrate, solution, check);
      if (!solution.calibration_summary.IsUsable()) break;
      changed = CorrectTimeJump(original, capture, solution, check);
      if (changed) solution = calibrate(capture);
    }
    if (!solution.calibration_summary.IsUsable()) break;
    changed |= examination.Run();
    if (ForgetTimeJumps(original, capture, check)) {
      solution = calibrate(capture);
      changed = true;
    }
    if (!changed) break;
  }
  if (solution.calibration_summary.IsUsable()) KeepMajority(capture, check);
  return check;
}

}  // namespace canonpose
