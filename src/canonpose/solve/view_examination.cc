#include "canonpose/solve/view_examination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "canonpose/base/median.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/resection.h"

namespace canonpose {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// A view fits in a frame if the median joint is nearer than this to where the others see it, in body units, or nearer
/// than this multiple of the keypoints' scatter or of what it is in the frames that fit. Usually it is 0.5 to 1 %, and
/// 2 to 10 % where a view shows something else.
constexpr double kFitsInFrame = 0.02;
constexpr double kFitsScatters = 5.0;
constexpr double kFitsRelative = 3.0;
/// Larger errors count as this, and so do frames that cannot be compared.
constexpr double kWorstError = 0.03;
/// A view fits as a whole if this share of its frames does.
constexpr double kShareThatFits = 0.9;
/// Another reading than the obvious one must fit this much better, and nearly as well as the best in the frames that
/// fit.
constexpr double kReadingGain = 0.75;
constexpr double kReadingError = 1.5;
/// Another time must gain less than this share of what the best one gains; otherwise the motion repeats itself and says
/// nothing about time.
constexpr double kUniqueTime = 0.85;
constexpr double kOtherTimeSeconds = 0.4;
/// Times are compared in about this many frames of the view, and cameras fitted to so many.
constexpr std::size_t kSearchFrames = 40;
constexpr std::size_t kCameraFrames = 60;
/// Readings that fit worse than this multiple of the best one, in the frames that are compared, are not looked at
/// closely.
constexpr double kHopeless = 2.0;
constexpr int kMinOverlap = 25;
/// Shorter stretches are not judged.
constexpr double kMinStretchSeconds = 0.4;
constexpr double kFitWindowSeconds = 1.2;
constexpr int kMinFitFrames = 12;

/// A view's camera under one reading, and how well each of its frames fits.
struct ViewFit {
  ViewReading reading;
  std::vector<double> frame_errors;  ///< (T) median over joints, body units; NaN where nothing can be compared
  double error = std::numeric_limits<double>::infinity();  ///< median of the frames that fit
  double share = 0.0;                                      ///< of the comparable frames, those that fit
  int compared = 0;
  double badness = kWorstError;  ///< mean error over the frames, at most kWorstError each
  Resection camera;              ///< of a static view
};

/// A time in frames, and how much better the view fits there than badly.
struct TimeCandidate {
  double offset;
  double gain;
};

const TimeCandidate& BestOf(const std::vector<TimeCandidate>& candidates) {
  return *std::ranges::max_element(candidates, {}, &TimeCandidate::gain);
}

/// The best time, unless another, at least `distance` frames away, is nearly as good: then the motion repeats itself.
std::optional<double> UniqueTime(const std::vector<TimeCandidate>& candidates, double distance) {
  const TimeCandidate& best = BestOf(candidates);
  for (const TimeCandidate& other : candidates) {
    if (std::abs(other.offset - best.offset) >= distance && other.gain > kUniqueTime * best.gain) return std::nullopt;
  }
  return best.offset;
}

class Examiner {
 public:
  Examiner(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion, double log_focal,
           double scatter)
      : capture_(capture),
        clip_(capture.clips[static_cast<std::size_t>(clip)]),
        view_(view),
        motion_(motion),
        log_focal_(log_focal),
        scatter_(scatter) {}

  [[nodiscard]] ViewExamination Examine() const;
  [[nodiscard]] double ShareAsRecorded() const { return Fit({}).share; }

 private:
  /// The sightings of the view's frame t at a time of the others.
  [[nodiscard]] std::vector<Sighting> SightingsOf(int t, double time, const ViewReading& reading) const;
  [[nodiscard]] std::vector<int> ComparableFrames(const ViewReading& reading) const;
  [[nodiscard]] Resection FitCamera(const std::vector<int>& frames, const ViewReading& reading, bool with_focal) const;
  /// The median error of the view's frame t; NaN where fewer than four joints can be compared.
  [[nodiscard]] double FrameError(int t, double time, const ViewReading& reading, const Resection& camera) const;
  [[nodiscard]] ViewFit Fit(const ViewReading& reading) const;
  void Rate(ViewFit& fit) const;
  [[nodiscard]] double FitsInFrame() const { return std::max(kFitsInFrame, kFitsScatters * scatter_); }
  /// The largest error at which a frame fits, given that of those that fit.
  [[nodiscard]] double Limit(double error) const { return std::max(FitsInFrame(), kFitsRelative * error); }
  /// The camera that fits the largest number of frames, from windows of the clip; `camera` invalid if none does.
  [[nodiscard]] Resection BestCameraOfWindows(const std::vector<int>& frames, const ViewReading& reading) const;
  [[nodiscard]] double ErrorAtTime(const ViewReading& reading, const std::vector<int>& frames) const;
  /// The best time of a reading among all offsets; nothing where it is not clearly better than others.
  [[nodiscard]] std::optional<ViewReading> FindTime(ViewReading reading) const;
  [[nodiscard]] std::vector<ViewReading> OtherReadings() const;
  [[nodiscard]] std::vector<BadStretch> FindBadStretches(const ViewFit& fit) const;
  /// By how many frames a stretch of time jumps, given its error at the time of the others plus so many frames; 0 where
  /// no jump brings the error below the limit, or several do because the motion repeats itself.
  [[nodiscard]] int FindJump(const std::function<double(int)>& error_after, double limit) const;
  void NameFault(const ViewFit& fit, double limit, BadStretch& stretch) const;

  const CaptureObservations& capture_;
  const ClipRange& clip_;
  int view_;
  const KnownMotion& motion_;
  double log_focal_;
  double scatter_;
};

std::vector<Sighting> Examiner::SightingsOf(int t, double time, const ViewReading& reading) const {
  std::vector<Sighting> sightings;
  if (!(time >= 0.0 && time <= clip_.count - 1.0)) return sightings;
  const int frame = clip_.first + t;
  for (int j = 0; j < capture_.joint_count(); ++j) {
    const int seen = reading.sides_are_exchanged ? capture_.skeleton.mirror[static_cast<std::size_t>(j)] : j;
    if (!capture_.Sees(frame, view_, seen)) continue;
    const Eigen::Vector3d joint = motion_.At(time, j);
    if (joint.allFinite()) sightings.push_back({joint, reading.Read(capture_.At(frame, view_, seen))});
  }
  return sightings;
}

std::vector<int> Examiner::ComparableFrames(const ViewReading& reading) const {
  std::vector<int> frames;
  for (int t = 0; t < clip_.count; ++t) {
    if (SightingsOf(t, reading.time.At(t), reading).size() >= 4) frames.push_back(t);
  }
  return frames;
}

Resection Examiner::FitCamera(const std::vector<int>& frames, const ViewReading& reading, bool with_focal) const {
  std::vector<Sighting> sightings;
  for (const int t : EvenlySpread(frames, static_cast<int>(kCameraFrames))) {
    const std::vector<Sighting> more = SightingsOf(t, reading.time.At(t), reading);
    sightings.insert(sightings.end(), more.begin(), more.end());
  }
  return with_focal ? ResectWithFocal(sightings, log_focal_, 2.0 * scatter_)
                    : Resect(sightings, log_focal_, 2.0 * scatter_);
}

double Examiner::FrameError(int t, double time, const ViewReading& reading, const Resection& camera) const {
  const std::vector<Sighting> sightings = SightingsOf(t, time, reading);
  if (sightings.size() < 4) return kUnknown;
  if (!capture_.static_cameras) {
    const Resection own = Resect(sightings, log_focal_, 2.0 * scatter_);
    return own.valid ? Median(own.errors) : kUnknown;
  }
  std::vector<double> errors;
  for (const Sighting& sighting : sightings) errors.push_back(camera.ErrorOf(sighting));
  return Median(std::move(errors));
}

void Examiner::Rate(ViewFit& fit) const {
  std::vector<double> fitting;
  fit.compared = 0;
  double sum = 0.0;
  for (const double error : fit.frame_errors) {
    if (!std::isfinite(error)) continue;
    ++fit.compared;
    sum += std::min(error, kWorstError);
    if (error < FitsInFrame()) fitting.push_back(error);
  }
  // A view that is slower or faster than the others shares only some of its frames with them.
  const double possible = clip_.count / std::max(1.0, std::abs(fit.reading.time.rate));
  fit.badness = (sum + std::max(0.0, possible - fit.compared) * kWorstError) / std::max<double>(possible, fit.compared);
  if (fitting.empty()) return;
  fit.error = Median(fitting);
  const double limit = Limit(fit.error);
  const auto fits = std::ranges::count_if(fit.frame_errors, [&](double error) { return error < limit; });
  fit.share = static_cast<double>(fits) / fit.compared;
}

Resection Examiner::BestCameraOfWindows(const std::vector<int>& frames, const ViewReading& reading) const {
  const auto length = static_cast<std::size_t>(std::max<double>(kMinFitFrames, kFitWindowSeconds * clip_.fps));
  Resection best;
  std::size_t most = 0;
  const auto attempt = [&](const std::vector<int>& some) {
    Resection camera = FitCamera(some, reading, false);
    std::vector<int> inliers;
    for (int round = 0; camera.valid && round < 3; ++round) {
      inliers.clear();
      for (const int t : frames) {
        const double limit = (round == 0 ? 2.0 : 1.0) * FitsInFrame();
        if (FrameError(t, reading.time.At(t), reading, camera) < limit) inliers.push_back(t);
      }
      if (inliers.size() < static_cast<std::size_t>(kMinFitFrames)) return;
      // Once more with all frames that fit: a window alone leaves the camera uncertain.
      if (round < 2) camera = FitCamera(inliers, reading, true);
    }
    if (!camera.valid || inliers.size() <= most) return;
    most = inliers.size();
    best = std::move(camera);
  };
  attempt(frames);
  for (std::size_t begin = 0; begin < frames.size(); begin += std::max<std::size_t>(1, length / 2)) {
    if (static_cast<double>(most) >= kShareThatFits * static_cast<double>(frames.size())) break;
    const std::size_t end = std::min(frames.size(), begin + length);
    if (end - begin < std::min<std::size_t>(length, frames.size()) / 2) break;
    attempt({frames.begin() + static_cast<std::ptrdiff_t>(begin), frames.begin() + static_cast<std::ptrdiff_t>(end)});
  }
  return best;
}

ViewFit Examiner::Fit(const ViewReading& reading) const {
  ViewFit fit;
  fit.reading = reading;
  fit.frame_errors.assign(static_cast<std::size_t>(clip_.count), kUnknown);
  const std::vector<int> frames = ComparableFrames(reading);
  if (frames.size() < static_cast<std::size_t>(kMinFitFrames)) return fit;
  if (capture_.static_cameras) {
    fit.camera = BestCameraOfWindows(frames, reading);
    if (!fit.camera.valid) return fit;
  }
  for (const int t : frames) {
    fit.frame_errors[static_cast<std::size_t>(t)] = FrameError(t, reading.time.At(t), reading, fit.camera);
  }
  Rate(fit);
  return fit;
}

double Examiner::ErrorAtTime(const ViewReading& reading, const std::vector<int>& frames) const {
  if (capture_.static_cameras) {
    const Resection camera = FitCamera(frames, reading, false);
    return camera.valid ? Median(camera.errors) : std::numeric_limits<double>::infinity();
  }
  std::vector<double> errors;
  for (const int t : frames) {
    const double error = FrameError(t, reading.time.At(t), reading, {});
    if (std::isfinite(error)) errors.push_back(error);
  }
  return errors.empty() ? std::numeric_limits<double>::infinity() : Median(std::move(errors));
}

std::optional<ViewReading> Examiner::FindTime(ViewReading reading) const {
  const double rate = reading.time.rate;
  const int count = clip_.count;
  const int min_overlap = std::max(kMinOverlap, count / 4);
  std::vector<TimeCandidate> candidates;  // whose gain is the share of the frames that overlap, times their fit
  const double possible = count / std::max(1.0, std::abs(rate));
  const auto evaluate = [&](double offset) {
    reading.time.offset = offset;
    // The view's frames whose time lies in the clip.
    std::vector<int> frames;
    for (int t = 0; t < count; ++t) {
      const double time = reading.time.At(t);
      if (time >= 0.0 && time <= count - 1.0 && capture_.Sees(clip_.first + t, view_, capture_.skeleton.root)) {
        frames.push_back(t);
      }
    }
    if (static_cast<int>(frames.size()) < min_overlap * std::min(1.0, 1.0 / std::abs(rate))) return;
    const double error = ErrorAtTime(reading, EvenlySpread(frames, static_cast<int>(kSearchFrames)));
    const double overlap = static_cast<double>(frames.size()) / possible;
    candidates.push_back({offset, overlap * std::max(0.0, kWorstError - error)});
  };
  const double span = std::abs(rate) * count;
  const double from = rate > 0.0 ? min_overlap - span : min_overlap - 1.0;
  const double to = rate > 0.0 ? count - min_overlap : span + count - min_overlap;
  const double step = std::max(1.0, std::round(clip_.fps / 12.0));
  const auto evaluate_from = [&](double first, double last, double by) {
    for (int i = 0; first + i * by <= last; ++i) evaluate(first + i * by);
  };
  evaluate_from(std::ceil(from), to, step);
  if (candidates.empty()) return std::nullopt;
  const double coarse = BestOf(candidates).offset;
  evaluate_from(coarse - step, coarse + step, 1.0);
  const std::optional<double> offset =
      UniqueTime(candidates, kOtherTimeSeconds * clip_.fps * std::max(1.0, std::abs(rate)));
  if (!offset) return std::nullopt;
  reading.time.offset = *offset;
  return reading;
}

std::vector<ViewReading> Examiner::OtherReadings() const {
  std::vector<ViewReading> images(4);
  images[1].is_mirrored = images[1].sides_are_exchanged = true;
  images[2].is_mirrored = true;
  images[3].sides_are_exchanged = true;
  std::vector<ViewReading> readings;
  for (const ViewReading& image : images) {
    if (!image.IsIdentity()) readings.push_back(image);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    for (const double rate : {1.0, 2.0, 0.5, -1.0}) {
      ViewReading reading = images[i];
      reading.time.rate = rate;
      if (const std::optional<ViewReading> found = FindTime(reading)) readings.push_back(*found);
    }
  }
  return readings;
}

std::vector<BadStretch> Examiner::FindBadStretches(const ViewFit& fit) const {
  const double limit = Limit(fit.error);
  const int reach = std::max(2, static_cast<int>(0.1 * clip_.fps));
  // The median over a few frames decides, so that single bad detections do not.
  std::vector<bool> is_bad(static_cast<std::size_t>(clip_.count), false);
  for (int t = 0; t < clip_.count; ++t) {
    std::vector<double> near;
    for (int n = std::max(0, t - reach); n <= std::min(clip_.count - 1, t + reach); ++n) {
      if (std::isfinite(fit.frame_errors[static_cast<std::size_t>(n)])) {
        near.push_back(fit.frame_errors[static_cast<std::size_t>(n)]);
      }
    }
    is_bad[static_cast<std::size_t>(t)] = !near.empty() && Median(std::move(near)) > limit;
  }
  std::vector<BadStretch> stretches;
  const int min_frames = std::max(5, static_cast<int>(kMinStretchSeconds * clip_.fps));
  const auto close = [&](int first, int end) {
    if (first >= 0 && end - first >= min_frames) stretches.push_back({first, end - first});
  };
  int first = -1;
  for (int t = 0; t < clip_.count; ++t) {
    const bool bad = is_bad[static_cast<std::size_t>(t)];
    if (bad && first < 0) first = t;
    if (!bad) {
      close(first, t);
      first = -1;
    }
  }
  close(first, clip_.count);
  for (BadStretch& stretch : stretches) NameFault(fit, limit, stretch);
  return stretches;
}

int Examiner::FindJump(const std::function<double(int)>& error_after, double limit) const {
  const int max_jump = std::min(clip_.count / 2, static_cast<int>(5.0 * clip_.fps));
  std::vector<TimeCandidate> candidates;
  for (int jump = -max_jump; jump <= max_jump; ++jump) {
    candidates.push_back({static_cast<double>(jump), std::max(0.0, limit - error_after(jump))});
  }
  if (!(BestOf(candidates).gain > 0.0)) return 0;
  return static_cast<int>(UniqueTime(candidates, kOtherTimeSeconds * clip_.fps).value_or(0.0));
}

void Examiner::NameFault(const ViewFit& fit, double limit, BadStretch& stretch) const {
  std::vector<int> frames;
  for (int t = stretch.first; t < stretch.first + stretch.count; ++t) {
    if (std::isfinite(fit.frame_errors[static_cast<std::size_t>(t)])) frames.push_back(t);
  }
  if (frames.size() < static_cast<std::size_t>(kMinFitFrames)) return;
  const auto median_error = [&](const Resection& camera, double jump) {
    std::vector<double> errors;
    for (const int t : frames) {
      const double error = FrameError(t, fit.reading.time.At(t) + jump, fit.reading, camera);
      if (std::isfinite(error)) errors.push_back(error);
    }
    return 2 * errors.size() < frames.size() ? std::numeric_limits<double>::infinity() : Median(std::move(errors));
  };
  if (const int jump = FindJump([&](int frames_later) { return median_error(fit.camera, frames_later); }, limit)) {
    stretch.fault = StretchFault::kTimeJump;
    stretch.jump_frames = jump;
    return;
  }
  if (!capture_.static_cameras) return;
  // A camera that was moved does not move back.
  const auto count_fitting = [&](int first, int end) {
    return std::count_if(fit.frame_errors.begin() + first, fit.frame_errors.begin() + end,
                         [&](double error) { return error < limit; });
  };
  const bool moved_back = count_fitting(0, stretch.first) >= kMinFitFrames &&
                          count_fitting(stretch.first + stretch.count, clip_.count) >= kMinFitFrames;
  if (moved_back) return;
  const Resection moved = BestCameraOfWindows(frames, fit.reading);
  if (moved.valid && median_error(moved, 0.0) < limit) stretch.fault = StretchFault::kCameraMoved;
}

ViewExamination Examiner::Examine() const {
  std::vector<ViewFit> fits = {Fit({})};
  const std::vector<ViewReading> readings = OtherReadings();
  std::vector<double> errors;
  for (const ViewReading& reading : readings) {
    errors.push_back(ErrorAtTime(reading, EvenlySpread(ComparableFrames(reading), static_cast<int>(kSearchFrames))));
  }
  const double least = errors.empty() ? 0.0 : *std::ranges::min_element(errors);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (errors[i] <= kHopeless * least) fits.push_back(Fit(readings[i]));
  }
  const double least_error = std::ranges::min_element(fits, {}, &ViewFit::error)->error;
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < fits.size(); ++i) {
    if (fits[i].error > kReadingError * least_error) continue;
    if (fits[i].badness < (chosen == 0 ? kReadingGain : 1.0) * fits[chosen].badness) chosen = i;
  }
  const ViewFit best = std::move(fits[chosen]);
  ViewExamination result;
  result.reading = best.reading;
  result.error = best.error;
  if (best.compared == 0 || best.share * best.compared < kMinOverlap || best.share < 0.25) {
    result.reading = {};
    return result;
  }
  result.fits = true;
  result.bad = FindBadStretches(best);
  return result;
}

}  // namespace

KnownMotion::KnownMotion(const CaptureObservations& capture, const Solution& solution, int clip)
    : joint_count_(capture.joint_count()) {
  const ClipRange& range = capture.clips[static_cast<std::size_t>(clip)];
  frame_count_ = range.count;
  for (int t = 0; t < range.count; ++t) {
    for (int j = 0; j < joint_count_; ++j) {
      joints_.push_back(TriangulateJoint(capture, range.first + t, j, solution.scales, solution.estimate).point);
    }
  }
}

Eigen::Vector3d KnownMotion::At(double time, int joint) const {
  const auto before = static_cast<int>(std::floor(time));
  if (before < 0 || before >= frame_count_) return Eigen::Vector3d::Constant(kUnknown);
  const double share = time - before;
  const auto at = [&](int frame) -> const Eigen::Vector3d& {
    return joints_[static_cast<std::size_t>(frame) * static_cast<std::size_t>(joint_count_) +
                   static_cast<std::size_t>(joint)];
  };
  if (share < 1e-9) return at(before);
  if (before + 1 >= frame_count_) return Eigen::Vector3d::Constant(kUnknown);
  return (1.0 - share) * at(before) + share * at(before + 1);
}

double ShareThatFits(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion,
                     double expected_log_focal, double scatter) {
  return Examiner(capture, clip, view, motion, expected_log_focal, scatter).ShareAsRecorded();
}

ViewExamination ExamineView(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion,
                            double expected_log_focal, double scatter) {
  return Examiner(capture, clip, view, motion, expected_log_focal, scatter).Examine();
}

}  // namespace canonpose
