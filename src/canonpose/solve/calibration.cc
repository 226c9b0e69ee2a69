#include "canonpose/solve/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/rotation_averaging.h"

namespace canonpose {
namespace {

/// Rotations need more frames than the adjustment, and cost less.
constexpr int kRotationFrames = 2000;
/// Relative rotations of moving cameras are averaged over this long before and after.
constexpr double kRotationSeconds = 0.5;
/// Runs of consecutive frames that moving cameras are calibrated from.
constexpr int kRuns = 6;
constexpr int kRunFrames = 50;
constexpr int kMovingIterations = 15;

/// Adjusts with the scatter of keypoints as it was measured last, and measures it again.
AdjustmentSummary AdjustToNoise(const CaptureObservations& capture, std::span<const int> frames, int fixed_view,
                                int max_iterations, Solution& solution) {
  AdjustmentOptions options;
  options.fixed_view = fixed_view;
  options.scales = solution.scales;
  options.loss_scale = kLossScale;
  options.iterations = max_iterations;
  AdjustmentSummary summary = Adjust(capture, frames, options, solution.estimate);
  if (summary.IsUsable()) solution.scales.observation = MeasureNoise(capture, frames, solution.estimate);
  return summary;
}

/// Adjusts first with a wide loss, since the start may be far off, then by AdjustToNoise().
AdjustmentSummary AdjustTwice(const CaptureObservations& capture, std::span<const int> frames, int fixed_view,
                              int max_iterations, Solution& solution) {
  const bool has_joints =
      std::ranges::any_of(solution.estimate.joints, [](const Eigen::Vector3d& joint) { return joint.allFinite(); });
  if (!has_joints) return {.reason = "the poses to start from contradict the keypoints in every frame"};
  AdjustmentOptions options;
  options.fixed_view = fixed_view;
  options.scales = solution.scales;
  options.scales.observation = MeasureNoise(capture, frames, solution.estimate);
  options.loss_scale = 3.0;
  options.iterations = 10;
  AdjustmentSummary coarse = Adjust(capture, frames, options, solution.estimate);
  if (!coarse.IsUsable()) return coarse;
  solution.scales.observation = MeasureNoise(capture, frames, solution.estimate);
  return AdjustToNoise(capture, frames, fixed_view, max_iterations, solution);
}

/// What one of the two mirrors came to after each adjustment; the last is the result.
using Stages = std::vector<Solution>;

/// By how many standard errors the first mirror explains the frames better than the second after every adjustment: the
/// smallest of these leads, 0 where the lead changes sides.
double LastingPreference(const CaptureObservations& capture, std::span<const int> frames, const Stages& a,
                         const Stages& b) {
  double smallest = Preference(capture, frames, a.front(), b.front());
  for (std::size_t i = 1; i < a.size(); ++i) {
    const double preference = Preference(capture, frames, a[i], b[i]);
    if (preference * smallest <= 0.0) return 0.0;
    if (std::abs(preference) < std::abs(smallest)) smallest = preference;
  }
  return smallest;
}

/// Solves from the start's poses and from their mirror, and keeps the solution that explains the keypoints better.
/// Where the evidence is not decisive, keeps the start's: a lifter has learnt what people look like, or its own mirror
/// was decided in training; after a factorisation either is as good.
Solution DecideMirror(const CaptureObservations& capture, std::span<const int> frames,
                      const CalibrationOptions& options, const std::function<Stages(bool mirrored)>& solve) {
  if (options.mirror != "auto") return std::move(solve(options.mirror == "flip").back());
  std::array<Stages, 2> stages;
  InParallel(2, options.threads, [&](int i) { stages[static_cast<std::size_t>(i)] = solve(i == 1); });
  // A mirror that could not be adjusted is not evidence either way.
  if (!stages[0].back().calibration_summary.IsUsable() || !stages[1].back().calibration_summary.IsUsable()) {
    return std::move(stages[0].back());
  }
  const double preference = LastingPreference(capture, frames, stages[0], stages[1]);
  Solution& best = stages[preference < -kDecisiveSigma ? 1 : 0].back();
  best.mirror_sigma = std::abs(preference);
  if (preference < 0.0 && !best.mirrored) best.mirror_sigma = preference;
  return std::move(best);
}

int ReferenceView(std::span<const Eigen::Matrix3d> camera_from_world) {
  for (std::size_t v = 0; v < camera_from_world.size(); ++v) {
    if (camera_from_world[v].isIdentity(1e-12)) return static_cast<int>(v);
  }
  return -1;
}

/// Gives every frame the median focal length that its camera has in `frames`.
void SpreadFocalLengths(const CaptureObservations& capture, std::span<const int> frames, Solution& solution) {
  std::vector<double>& expected = solution.scales.expected_log_focal;
  expected.assign(capture.cameras.size(), 0.0);
  for (int v = 0; v < capture.view_count(); ++v) {
    std::vector<double> found;
    for (const int frame : frames) {
      const CameraEstimate& camera = solution.estimate.CameraAt(frame, v);
      if (camera.valid) found.push_back(camera.log_focal);
    }
    if (found.empty()) continue;
    double& focal = expected[static_cast<std::size_t>(v)];
    focal = Median(std::move(found));
    for (int n = 0; n < capture.frame_count; ++n) {
      if (!std::binary_search(frames.begin(), frames.end(), n)) solution.estimate.CameraAt(n, v).log_focal = focal;
    }
  }
}

}  // namespace

std::vector<int> FramesWithStart(const CaptureObservations& capture) {
  std::vector<int> frames;
  for (int n = 0; n < capture.frame_count; ++n) {
    int views = 0;
    for (int v = 0; v < capture.view_count(); ++v) views += capture.HasStart(n, v) ? 1 : 0;
    if (views >= 2) frames.push_back(n);
  }
  return frames;
}

std::vector<int> CalibrationFrames(const CaptureObservations& capture, const CalibrationOptions& options) {
  return capture.static_cameras ? EvenlySpread(FramesWithStart(capture), options.frames)
                                : EvenRuns(ConsecutiveFrames(0, capture.frame_count), kRuns, kRunFrames);
}

Solution CalibrateStatic(const CaptureObservations& capture, const CalibrationOptions& options) {
  const std::vector<int> usable = FramesWithStart(capture);
  const std::vector<int> frames = CalibrationFrames(capture, options);
  const StaticRotations rotations = AverageStaticRotations(capture, EvenlySpread(usable, kRotationFrames));
  return DecideMirror(capture, frames, options, [&](bool mirrored) {
    std::vector<Eigen::Matrix3d> camera_from_world = rotations.camera_from_world;
    if (mirrored) std::ranges::transform(camera_from_world, camera_from_world.begin(), MirrorRotation);
    Solution solution;
    solution.mirrored = mirrored;
    solution.estimate = InitialiseStatic(capture, frames, camera_from_world, mirrored, options.first_focal);
    solution.calibration_summary =
        AdjustTwice(capture, frames, ReferenceView(camera_from_world), options.max_iterations, solution);
    return Stages{std::move(solution)};
  });
}

Solution CalibrateMoving(const CaptureObservations& capture, const CalibrationOptions& options) {
  const std::vector<int> usable = FramesWithStart(capture);
  const std::vector<int> frames = CalibrationFrames(capture, options);
  const auto rotations = SmoothedRotations(capture, kRotationSeconds);
  return DecideMirror(capture, frames, options, [&](bool mirrored) {
    auto camera_from_world = rotations;
    for (std::vector<Eigen::Matrix3d>& views : camera_from_world) {
      if (mirrored) std::ranges::transform(views, views.begin(), MirrorRotation);
    }
    Solution solution;
    solution.mirrored = mirrored;
    solution.estimate = InitialiseMoving(capture, usable, camera_from_world, mirrored);
    solution.scales.acceleration = MeasureAccelerations(capture, solution.estimate);
    solution.calibration_summary = AdjustTwice(capture, frames, -1, kMovingIterations, solution);
    if (!solution.calibration_summary.IsUsable()) return Stages{std::move(solution)};
    solution.scales.angular_velocity = MeasureAngularVelocity(capture, frames, solution.estimate);
    Stages stages{solution};
    // Once more with the measured angular velocity: a lead that only one of the adjustments shows is chance.
    solution.calibration_summary = AdjustToNoise(capture, frames, -1, kMovingIterations, solution);
    if (!solution.calibration_summary.IsUsable()) return Stages{std::move(solution)};
    solution.scales.angular_velocity = MeasureAngularVelocity(capture, frames, solution.estimate);
    SpreadFocalLengths(capture, frames, solution);
    stages.push_back(std::move(solution));
    return stages;
  });
}

}  // namespace canonpose
