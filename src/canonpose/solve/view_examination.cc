#include "canonpose/solve/view_examination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "canonpose/base/median.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/resection.h"

namespace canonpose {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// A view fits in a frame if the median joint is nearer than this to where the others see it, in body units, or nearer
/// than this multiple of what it is in the frames that fit. Simulated captures: 0.5 to 1 % usually, 3 to 10 % where a
/// view shows something else.
constexpr double kFitsInFrame = 0.02;
constexpr double kFitsRelative = 3.0;
/// A view fits as a whole if this share of its frames does.
constexpr double kShareThatFits = 0.9;
/// Another reading than the obvious one must fit this much better (median error), or in this many more frames.
constexpr double kReadingGain = 0.6;
constexpr double kReadingShareGain = 0.2;
/// The second best time must be worse by this factor; otherwise the motion repeats itself and says nothing about time.
constexpr double kUniqueTime = 1.25;
constexpr double kOtherTimeSeconds = 0.4;
/// Times are compared in about this many frames of the view.
constexpr int kSearchFrames = 50;
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
  Resection camera;  ///< of a static view
};

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

 private:
  /// The sightings of the view's frame t at a time of the others.
  [[nodiscard]] std::vector<Sighting> SightingsOf(int t, double time, const ViewReading& reading) const;
  [[nodiscard]] std::vector<int> ComparableFrames(const ViewReading& reading) const;
  [[nodiscard]] Resection FitCamera(const std::vector<int>& frames, const ViewReading& reading, bool with_focal) const;
  /// The median error of the view's frame t; NaN where fewer than four joints can be compared.
  [[nodiscard]] double FrameError(int t, double time, const ViewReading& reading, const Resection& camera) const;
  [[nodiscard]] ViewFit Fit(const ViewReading& reading) const;
  void Rate(ViewFit& fit) const;
  /// The camera that fits the largest number of frames, from windows of the clip; `camera` invalid if none does.
  [[nodiscard]] Resection BestCameraOfWindows(const std::vector<int>& frames, const ViewReading& reading) const;
  [[nodiscard]] double ErrorAtTime(const ViewReading& reading, const std::vector<int>& frames) const;
  /// The best time of a reading among all offsets; nothing where it is not clearly better than others.
  [[nodiscard]] std::optional<ViewReading> FindTime(ViewReading reading) const;
  [[nodiscard]] std::vector<ViewReading> OtherReadings() const;
  [[nodiscard]] std::vector<BadStretch> FindBadStretches(const ViewFit& fit) const;
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
  for (const int t : frames) {
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

/// The largest error at which a frame fits, given those that fit.
double Limit(double error) { return std::max(kFitsInFrame, kFitsRelative * error); }

void Examiner::Rate(ViewFit& fit) const {
  std::vector<double> fitting;
  fit.compared = 0;
  for (const double error : fit.frame_errors) {
    if (!std::isfinite(error)) continue;
    ++fit.compared;
    if (error < kFitsInFrame) fitting.push_back(error);
  }
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
  for (std::size_t begin = 0; begin < frames.size(); begin += std::max<std::size_t>(1, length / 2)) {
    const std::size_t end = std::min(frames.size(), begin + length);
    if (end - begin < std::min<std::size_t>(length, frames.size()) / 2) break;
    Resection camera = FitCamera(
        {frames.begin() + static_cast<std::ptrdiff_t>(begin), frames.begin() + static_cast<std::ptrdiff_t>(end)},
        reading, true);
    if (!camera.valid) continue;
    // Once more with all frames that fit: a window alone leaves the camera uncertain.
    std::vector<int> inliers;
    for (int round = 0; round < 3; ++round) {
      inliers.clear();
      for (const int t : frames) {
        const double limit = (round == 0 ? 2.0 : 1.0) * kFitsInFrame;
        if (FrameError(t, reading.time.At(t), reading, camera) < limit) inliers.push_back(t);
      }
      if (inliers.size() < static_cast<std::size_t>(kMinFitFrames)) break;
      Resection again = FitCamera(inliers, reading, true);
      if (!again.valid) break;
      camera = std::move(again);
    }
    if (inliers.size() <= most) continue;
    most = inliers.size();
    best = std::move(camera);
    if (most == frames.size()) break;
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
  struct Candidate {
    double offset;
    double error;
  };
  std::vector<Candidate> candidates;
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
    const std::size_t step = std::max<std::size_t>(1, frames.size() / kSearchFrames);
    std::vector<int> some;
    for (std::size_t i = 0; i < frames.size(); i += step) some.push_back(frames[i]);
    candidates.push_back({offset, ErrorAtTime(reading, some)});
  };
  const double span = std::abs(rate) * count;
  const double from = rate > 0.0 ? min_overlap - span : min_overlap - 1.0;
  const double to = rate > 0.0 ? count - min_overlap : span + count - min_overlap;
  const double step = std::max(1.0, std::round(clip_.fps / 12.0));
  for (double offset = std::ceil(from); offset <= to; offset += step) evaluate(offset);
  if (candidates.empty()) return std::nullopt;
  const auto best_of = [&] { return *std::ranges::min_element(candidates, {}, &Candidate::error); };
  const Candidate coarse = best_of();
  for (double offset = coarse.offset - step; offset <= coarse.offset + step; offset += 1.0) evaluate(offset);
  const Candidate best = best_of();
  for (const Candidate& other : candidates) {
    if (std::abs(other.offset - best.offset) < kOtherTimeSeconds * clip_.fps * std::max(1.0, std::abs(rate))) continue;
    if (other.error < kUniqueTime * best.error) return std::nullopt;
  }
  reading.time.offset = best.offset;
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
  // The same camera at another time.
  const int max_jump = std::min(clip_.count / 2, static_cast<int>(5.0 * clip_.fps));
  double least = std::numeric_limits<double>::infinity();
  int best_jump = 0;
  for (int jump = -max_jump; jump <= max_jump; ++jump) {
    const double error = median_error(fit.camera, jump);
    if (error < least) {
      least = error;
      best_jump = jump;
    }
  }
  if (least < limit && best_jump != 0) {
    stretch.fault = StretchFault::kTimeJump;
    stretch.jump_frames = best_jump;
    return;
  }
  if (!capture_.static_cameras) return;
  const Resection moved = BestCameraOfWindows(frames, fit.reading);
  if (moved.valid && median_error(moved, 0.0) < limit) stretch.fault = StretchFault::kCameraMoved;
}

ViewExamination Examiner::Examine() const {
  ViewFit best = Fit({});
  if (best.share < kShareThatFits) {
    const ViewFit obvious = best;
    for (const ViewReading& reading : OtherReadings()) {
      ViewFit other = Fit(reading);
      // A reading that leaves little to compare cannot win.
      if (other.compared * std::max(1.0, std::abs(reading.time.rate)) < std::max(kMinOverlap, clip_.count / 4))
        continue;
      const bool fits_better = other.share > obvious.share + kReadingShareGain ||
                               (other.share >= obvious.share && other.error < kReadingGain * obvious.error);
      const bool is_best = best.reading.IsIdentity() || other.share > best.share + 0.05 ||
                           (other.share > best.share - 0.05 && other.error < best.error);
      if (fits_better && is_best) best = std::move(other);
    }
  }
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

ViewExamination ExamineView(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion,
                            double expected_log_focal, double scatter) {
  return Examiner(capture, clip, view, motion, expected_log_focal, scatter).Examine();
}

}  // namespace canonpose
