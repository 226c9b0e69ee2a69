#include "canonpose/solve/synchronisation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/clock_candidates.h"
#include "canonpose/solve/clock_refinement.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/view_resampling.h"

namespace canonpose {
namespace {

/// What views must have in common to be compared, or this share of the shortest recording where that is less.
constexpr double kMinOverlapSeconds = 5.0;
constexpr double kMinOverlapShare = 0.5;
/// Candidates whose motion is less alike than this share of the likeliest one's are not tried; the second share is that
/// where the evidence is weak.
constexpr double kWorthTrying = 0.8;
constexpr double kWorthTryingInDoubt = 0.4;
/// Rounds of calibration and refinement, for every candidate and for the best of them; they end where no clock moves by
/// more than this.
constexpr int kFirstRounds = 1;
constexpr int kClockRounds = 4;
/// Of moving cameras, whose calibration takes long and hardly depends on the clocks.
constexpr int kMovingRounds = 2;
constexpr double kSettledFrames = 0.05;
/// A clock moves by at most this in a round; beyond, velocities say nothing.
constexpr double kLargestStepSeconds = 0.15;
/// Rates that are not known are known to this after the usual ratios have been tried: 29.97 and 30 differ by 1e-3.
constexpr double kUnknownRate = 2e-3;
constexpr double kKnownRate = 5e-5;
/// A drift that shifts no frame of the clip by more than this is not worth a rate of its own.
constexpr double kNegligibleSeconds = 0.002;
/// Candidates whose views are apart by less are one.
constexpr double kSamePlaceSeconds = 0.12;
/// Errors are capped here, in body units, as in CappedError().
constexpr double kLargestError = 0.03;

/// A view is placed where its motion is this much more like the others' than by chance, in standard deviations (other
/// places reach 8), ...
constexpr double kStrongEvidence = 12.0;
/// ... no other place that was tried has an error below this multiple of the best one's ...
constexpr double kClearlyBetter = 1.08;
/// ... or, with the first evidence, all of them have the second multiple, as in recordings of a second or two, ...
constexpr double kMinEvidence = 5.0;
constexpr double kFarBetter = 1.3;
/// ... and the place is known to this.
constexpr double kMaxDeviationSeconds = 0.015;
/// Below this multiple of the error as recorded, another candidate replaces it where cameras may be in step.
constexpr double kBetterThanRecorded = 0.9;

/// A candidate after calibration and refinement.
struct Trial {
  ClockCandidate candidate;
  std::vector<double> deviations;  ///< (V) of the offsets, frames
  double error = std::numeric_limits<double>::infinity();
  bool is_usable = false;
};

/// The root mean square error of keypoints per degree of freedom: a joint that two views see fits nearly always.
double ErrorPerFreedom(const CaptureObservations& capture, const Solution& solution) {
  std::vector<int> views(static_cast<std::size_t>(capture.frame_count) * capture.skeleton.joints.size(), 0);
  double squares = 0.0;
  VisitErrors(capture, ConsecutiveFrames(0, capture.frame_count), solution.estimate,
              [&](int n, int, int j, double error) {
                ++views[static_cast<std::size_t>(n) * capture.skeleton.joints.size() + static_cast<std::size_t>(j)];
                squares += std::pow(std::min(error, kLargestError), 2);
              });
  double freedom = 0.0;
  for (const int of_joint : views) freedom += of_joint >= 2 ? 2.0 * of_joint - 3.0 : 0.0;
  return freedom > 0.0 ? std::sqrt(squares / freedom) : std::numeric_limits<double>::infinity();
}

/// `a` after `b`.
TimeMap Compose(const TimeMap& a, const TimeMap& b) { return {a.rate * b.rate, a.rate * b.offset + a.offset}; }

TimeMap Inverse(const TimeMap& map) { return {1.0 / map.rate, -map.offset / map.rate}; }

class ClipSynchroniser {
 public:
  ClipSynchroniser(const CaptureObservations& capture, int clip, const GivenOffsets& given,
                   const Calibrate& calibrate_quickly)
      : recorded_(SingleClip(capture, clip)),
        clip_(capture.clips[static_cast<std::size_t>(clip)]),
        given_(given),
        calibrate_(calibrate_quickly) {
    CollectGiven();
  }
  /// The clocks of all views; sets `failure` where nothing can be done.
  [[nodiscard]] std::vector<ViewClockEstimate> Run(std::string& failure);

 private:
  void CollectGiven();
  [[nodiscard]] std::vector<ViewClockEstimate> AsGiven() const;
  [[nodiscard]] double MinOverlap() const;
  [[nodiscard]] std::vector<Trial> TryCandidates() const;
  /// Goes on with a trial for some rounds, or until its clocks stay.
  void Refine(int rounds, Trial& trial) const;
  /// One round; by how much the clocks moved, in frames.
  double Step(const CaptureObservations& in_step, const Solution& solution, Trial& trial) const;
  [[nodiscard]] bool AreApart(const Trial& a, const Trial& b, int view) const;
  /// What the trials say of each view, given the best one.
  [[nodiscard]] std::vector<ViewClockEstimate> Judge(const std::vector<Trial>& trials, const Trial& best) const;
  /// Counts time from the view that shares most with the others.
  void Rebase(std::vector<ViewClockEstimate>& clocks) const;
  [[nodiscard]] int FramesShared(const std::vector<ViewClockEstimate>& clocks, int reference) const;
  void DropDrifts(std::vector<ViewClockEstimate>& clocks) const;
  [[nodiscard]] bool ShowsAnything(int view) const;

  CaptureObservations recorded_;  ///< the clip alone
  ClipRange clip_;
  const GivenOffsets& given_;
  const Calibrate& calibrate_;
  std::vector<double> known_;  ///< (V) offsets in frames; NaN where not given
};

void ClipSynchroniser::CollectGiven() {
  bool any = false;
  for (const ObservedCamera& camera : recorded_.cameras) {
    const auto found = given_.find(camera.name);
    known_.push_back(found == given_.end() ? std::nan("") : found->second * clip_.fps);
    any = any || found != given_.end();
  }
  // What is given counts from the first view of which nothing is.
  if (!any) return;
  for (double& offset : known_) {
    if (std::isfinite(offset)) continue;
    offset = 0.0;
    return;
  }
}

bool ClipSynchroniser::ShowsAnything(int view) const {
  for (int n = 0; n < recorded_.frame_count; ++n) {
    for (int j = 0; j < recorded_.joint_count(); ++j) {
      if (recorded_.Sees(n, view, j)) return true;
    }
  }
  return false;
}

/// Offsets that are given, where all other cameras are in step.
std::vector<ViewClockEstimate> ClipSynchroniser::AsGiven() const {
  std::vector<ViewClockEstimate> clocks;
  for (std::size_t v = 0; v < known_.size(); ++v) {
    ViewClockEstimate& clock = clocks.emplace_back();
    clock.camera = recorded_.cameras[v].name;
    const bool is_given = given_.contains(clock.camera);
    clock.source = is_given ? ClockSource::kGiven : ClockSource::kAsRecorded;
    clock.time.offset = is_given ? known_[v] : 0.0;
  }
  return clocks;
}

double ClipSynchroniser::MinOverlap() const {
  double shortest = std::numeric_limits<double>::infinity();
  for (int v = 0; v < recorded_.view_count(); ++v) {
    int first = recorded_.frame_count;
    int last = -1;
    for (int n = 0; n < recorded_.frame_count; ++n) {
      if (!recorded_.Sees(n, v, recorded_.skeleton.root)) continue;
      first = std::min(first, n);
      last = n;
    }
    if (last >= first) shortest = std::min(shortest, (last - first + 1) / clip_.fps);
  }
  return std::min(kMinOverlapSeconds, kMinOverlapShare * shortest);
}

double ClipSynchroniser::Step(const CaptureObservations& in_step, const Solution& solution, Trial& trial) const {
  ClockStepOptions options;
  options.drift_deviation = clip_.fps_is_known ? kKnownRate : kUnknownRate;
  for (std::size_t v = 0; v < known_.size(); ++v) {
    options.fixed.push_back(std::isfinite(known_[v]) || static_cast<int>(v) == trial.candidate.root);
  }
  std::vector<int> frames = ConsecutiveFrames(0, in_step.frame_count);
  if (!in_step.static_cameras) frames = CalibrationFrames(in_step, {});
  const std::vector<ClockStep> steps = StepClocks(in_step, solution, 0, frames, options);
  const double largest = kLargestStepSeconds * clip_.fps;
  const double middle = 0.5 * (clip_.count - 1);
  double moved = 0.0;
  trial.deviations.assign(steps.size(), 0.0);
  for (std::size_t v = 0; v < steps.size(); ++v) {
    if (!steps[v].known) continue;
    const double offset = std::clamp(steps[v].offset, -largest, largest);
    const double drift = std::clamp(steps[v].drift, -kUnknownRate, kUnknownRate);
    trial.candidate.times[v] = Compose({1.0 + drift, offset - drift * middle}, trial.candidate.times[v]);
    trial.deviations[v] = steps[v].offset_deviation;
    moved = std::max(moved, std::abs(offset) + std::abs(drift) * middle);
  }
  return moved;
}

void ClipSynchroniser::Refine(int rounds, Trial& trial) const {
  CaptureObservations in_step = recorded_;
  for (int round = 0; round <= rounds; ++round) {
    ResampleClip(recorded_, 0, trial.candidate.times, in_step);
    if (static_cast<int>(FramesWithStart(in_step).size()) < kMinFrames) return;
    const Solution solution = calibrate_(in_step);
    if (!solution.calibration_summary.IsUsable()) return;
    trial.is_usable = true;
    trial.error = ErrorPerFreedom(in_step, solution);
    if (round == rounds || Step(in_step, solution, trial) < kSettledFrames) break;
  }
}

std::vector<Trial> ClipSynchroniser::TryCandidates() const {
  ClockSearch search;
  search.rates_are_equal = clip_.fps_is_known;
  search.known_offsets = known_;
  search.min_overlap_seconds = MinOverlap();
  search.as_recorded = clip_.timing == FrameTiming::kUnsure;
  std::vector<Trial> trials;
  const std::vector<ClockCandidate> candidates = FindClockCandidates(recorded_, 0, search);
  // A view with even less evidence is not placed in any case.
  const bool is_weak = !candidates.empty() && std::ranges::any_of(candidates.front().evidence, [](double evidence) {
    return evidence >= kMinEvidence && evidence < kStrongEvidence;
  });
  const double worth_trying = is_weak ? kWorthTryingInDoubt : kWorthTrying;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool is_last = i + 1 == candidates.size() && search.as_recorded;
    if (!is_last && candidates[i].score < worth_trying * candidates.front().score) continue;
    trials.emplace_back().candidate = candidates[i];
  }
  const int rounds = recorded_.static_cameras ? kClockRounds : kMovingRounds;
  for (Trial& trial : trials) Refine(trials.size() > 1 ? kFirstRounds : rounds, trial);
  if (trials.size() <= 1) return trials;
  const auto best = std::ranges::min_element(trials, std::ranges::less(), &Trial::error);
  if (best != trials.end() && best->is_usable) Refine(rounds, *best);
  return trials;
}

bool ClipSynchroniser::AreApart(const Trial& a, const Trial& b, int view) const {
  const auto i = static_cast<std::size_t>(view);
  const double middle = 0.5 * (clip_.count - 1);
  const double apart = a.candidate.times[i].At(middle) - b.candidate.times[i].At(middle);
  return std::abs(apart) > kSamePlaceSeconds * clip_.fps;
}

std::vector<ViewClockEstimate> ClipSynchroniser::Judge(const std::vector<Trial>& trials, const Trial& best) const {
  std::vector<ViewClockEstimate> clocks;
  for (int v = 0; v < recorded_.view_count(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    ViewClockEstimate& clock = clocks.emplace_back();
    clock.camera = recorded_.cameras[i].name;
    clock.time = best.candidate.times[i];
    clock.evidence = best.candidate.evidence[i];
    clock.deviation_seconds = best.deviations.empty() ? 0.0 : best.deviations[i] / clip_.fps;
    double runner_up = std::numeric_limits<double>::infinity();
    for (const Trial& trial : trials) {
      if (!trial.is_usable) continue;
      bool are_apart = AreApart(trial, best, v);
      // The root's own time is always the same: it is apart where another view is.
      for (int w = 0; v == best.candidate.root && w < recorded_.view_count(); ++w) {
        are_apart = are_apart || AreApart(trial, best, w);
      }
      if (are_apart) runner_up = std::min(runner_up, trial.error);
    }
    clock.runner_up = std::isfinite(runner_up) ? runner_up / best.error : 0.0;
    clock.source = given_.contains(clock.camera) ? ClockSource::kGiven : ClockSource::kMotion;
    if (clock.source == ClockSource::kGiven) continue;
    if (!ShowsAnything(v)) {
      clock.source = ClockSource::kUnknown;
      clock.reason = "never shows the person";
    } else if (clock.evidence < kMinEvidence || (clock.evidence < kStrongEvidence && clock.runner_up == 0.0)) {
      clock.source = ClockSource::kUnknown;
      clock.reason = "shows no motion that tells when it was recorded";
    } else if (clock.runner_up > 0.0 &&
               clock.runner_up < (clock.evidence < kStrongEvidence ? kFarBetter : kClearlyBetter)) {
      clock.source = ClockSource::kUnknown;
      clock.reason = "shows motion that repeats itself, so that it fits at several times";
    } else if (clock.deviation_seconds > kMaxDeviationSeconds) {
      clock.source = ClockSource::kUnknown;
      clock.reason =
          fmt::format("shows so little motion that its time is known to {:.0f} ms only", 1e3 * clock.deviation_seconds);
    }
  }
  return clocks;
}

int ClipSynchroniser::FramesShared(const std::vector<ViewClockEstimate>& clocks, int reference) const {
  const TimeMap from_root = Inverse(clocks[static_cast<std::size_t>(reference)].time);
  std::vector<int> views(static_cast<std::size_t>(clip_.count), 0);
  for (int v = 0; v < recorded_.view_count(); ++v) {
    if (clocks[static_cast<std::size_t>(v)].source == ClockSource::kUnknown) continue;
    const TimeMap own = Inverse(Compose(from_root, clocks[static_cast<std::size_t>(v)].time));
    for (int n = 0; n < clip_.count; ++n) {
      const long t = std::lround(own.At(n));
      if (t >= 0 && t < clip_.count && recorded_.Sees(static_cast<int>(t), v, recorded_.skeleton.root)) {
        ++views[static_cast<std::size_t>(n)];
      }
    }
  }
  return static_cast<int>(std::ranges::count_if(views, [](int count) { return count >= 2; }));
}

void ClipSynchroniser::Rebase(std::vector<ViewClockEstimate>& clocks) const {
  int best = -1;
  int most = -1;
  for (int v = 0; v < recorded_.view_count(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    if (clocks[i].source == ClockSource::kUnknown) continue;
    // What is given counts from the first view of which nothing is.
    const bool is_origin = !given_.empty() && known_[i] == 0.0 && !given_.contains(clocks[i].camera);
    const int shared = is_origin ? std::numeric_limits<int>::max() : FramesShared(clocks, v);
    if (shared <= most) continue;
    most = shared;
    best = v;
  }
  if (best < 0) return;
  const TimeMap to_reference = Inverse(clocks[static_cast<std::size_t>(best)].time);
  const double deviation = clocks[static_cast<std::size_t>(best)].deviation_seconds;
  for (ViewClockEstimate& clock : clocks) {
    clock.time = Compose(to_reference, clock.time);
    if (clock.source != ClockSource::kGiven) clock.deviation_seconds = std::hypot(clock.deviation_seconds, deviation);
  }
  ViewClockEstimate& reference = clocks[static_cast<std::size_t>(best)];
  reference.time = {};
  reference.deviation_seconds = 0.0;
  if (reference.source != ClockSource::kAsRecorded) reference.source = ClockSource::kReference;
}

void ClipSynchroniser::DropDrifts(std::vector<ViewClockEstimate>& clocks) const {
  const double middle = 0.5 * (clip_.count - 1);
  for (ViewClockEstimate& clock : clocks) {
    const double shift = std::abs(clock.time.rate - 1.0) * middle;
    if (shift > kNegligibleSeconds * clip_.fps) continue;
    clock.time = {1.0, clock.time.At(middle) - middle};
  }
}

/// Whether views may have begun together after all, though another candidate fits best.
bool MayBeInStep(const Trial& as_recorded, const Trial& best) {
  return as_recorded.is_usable && (best.error > kBetterThanRecorded * as_recorded.error ||
                                   best.candidate.score < as_recorded.candidate.score + kMinEvidence);
}

std::vector<ViewClockEstimate> ClipSynchroniser::Run(std::string& failure) {
  const bool is_all_known = std::ranges::all_of(known_, [](double offset) { return std::isfinite(offset); });
  if (clip_.timing == FrameTiming::kCommon || is_all_known) {
    std::vector<ViewClockEstimate> clocks = AsGiven();
    if (is_all_known) Rebase(clocks);
    return clocks;
  }
  const std::vector<Trial> trials = TryCandidates();
  const auto best = std::ranges::min_element(trials, std::ranges::less(), &Trial::error);
  if (best == trials.end() || !best->is_usable) {
    failure =
        "the cameras were not synchronised, and their motion does not tell when each began: no two of them agree "
        "at any time; give the `offset` of each, in seconds";
    return {};
  }
  if (clip_.timing == FrameTiming::kUnsure && MayBeInStep(trials.back(), *best)) return AsGiven();
  std::vector<ViewClockEstimate> clocks = Judge(trials, *best);
  Rebase(clocks);
  DropDrifts(clocks);
  const auto placed = std::ranges::count_if(
      clocks, [](const ViewClockEstimate& clock) { return clock.source != ClockSource::kUnknown; });
  if (placed < 2) {
    failure = fmt::format(
        "the cameras were not synchronised, and their motion does not tell when each began: {} {}; give the `offset` "
        "of each, in seconds",
        clocks.back().camera, clocks.back().reason);
  }
  return clocks;
}

}  // namespace

const char* NameOf(ClockSource source) {
  switch (source) {
    case ClockSource::kReference:
      return "reference";
    case ClockSource::kMotion:
      return "found";
    case ClockSource::kGiven:
      return "given";
    case ClockSource::kAsRecorded:
      return "as recorded";
    case ClockSource::kUnknown:
      break;
  }
  return "not found";
}

const ViewClockEstimate* Synchronisation::Find(int clip, std::string_view camera) const {
  const auto found = std::ranges::find_if(
      clocks, [&](const ViewClockEstimate& clock) { return clock.clip == clip && clock.camera == camera; });
  return found == clocks.end() ? nullptr : &*found;
}

std::pair<std::string, double> ParseOffset(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  double seconds = 0.0;
  if (equals != std::string::npos && equals > 0) {
    const char* const end = text.data() + text.size();
    const auto [after, error] = std::from_chars(text.data() + equals + 1, end, seconds);
    if (error == std::errc() && after == end && std::isfinite(seconds)) return {text.substr(0, equals), seconds};
  }
  ThrowInvalidArgument("`offset`: expected NAME=SECONDS, such as cam3=1.25, found \"{}\"", text);
}

bool NeedsSynchronising(const CaptureObservations& capture, const GivenOffsets& given) {
  const bool is_given =
      std::ranges::any_of(capture.cameras, [&](const ObservedCamera& camera) { return given.contains(camera.name); });
  return is_given ||
         std::ranges::any_of(capture.clips, [](const ClipRange& clip) { return clip.timing != FrameTiming::kCommon; });
}

Synchronisation Synchronise(CaptureObservations& capture, const GivenOffsets& given,
                            const Calibrate& calibrate_quickly) {
  Synchronisation result;
  result.times.assign(capture.clips.size(), std::vector<TimeMap>(capture.cameras.size()));
  if (!NeedsSynchronising(capture, given)) return result;
  const CaptureObservations recorded = capture;
  for (std::size_t c = 0; c < capture.clips.size(); ++c) {
    const auto clip = static_cast<int>(c);
    if (recorded.clips[c].timing == FrameTiming::kCommon && given.empty()) continue;
    std::vector<ViewClockEstimate> clocks =
        ClipSynchroniser(recorded, clip, given, calibrate_quickly).Run(result.failure);
    for (std::size_t v = 0; v < clocks.size(); ++v) {
      ViewClockEstimate& clock = clocks[v];
      clock.clip = clip;
      clock.offset_seconds = clock.time.offset / recorded.clips[c].fps;
      result.times[c][v] = clock.time;
      if (clock.source == ClockSource::kUnknown) {
        DropFrames(static_cast<int>(v), recorded.clips[c].first, recorded.clips[c].count, capture);
      } else if (!clock.time.IsIdentity()) {
        ResampleView(recorded, clip, static_cast<int>(v), clock.time, capture);
      }
      result.clocks.push_back(std::move(clock));
    }
    if (!result.failure.empty()) break;
  }
  return result;
}

}  // namespace canonpose
