// By how much cameras' clocks differ, to a fraction of a frame, from how keypoints move past the joints' projections.
#pragma once

#include <span>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// What has to be added to a view's time: offset + drift * (frames after the middle of the clip), in frames.
struct ClockStep {
  double offset = 0.0;
  double drift = 0.0;
  double offset_deviation = 0.0;  ///< standard deviation of `offset`
  bool known = false;             ///< false for the fixed view, and where nothing can be compared
};

struct ClockStepOptions {
  std::vector<bool> fixed;        ///< (V) views whose clocks are right; at least one
  double drift_deviation = 1e-4;  ///< how much rates are expected to differ by; cameras' quartzes keep within 100 ppm
};

/// One Gauss-Newton step for the clocks (V) of a clip's views, given cameras that are known in `frames` (ascending).
///
/// To first order a view whose time is off by s frames has keypoints that are off by s times their velocity. The least
/// squares problem has one s and one drift per view, a change of every camera (of all frames where cameras stand still,
/// otherwise of each frame), and every joint in every frame; joints and moving cameras are eliminated. Cameras must
/// take part, since those calibrated with wrong times partly compensate for them. Errors are weighted by Cauchy's loss
/// and the solution's scatter.
std::vector<ClockStep> StepClocks(const CaptureObservations& capture, const Solution& solution, int clip,
                                  std::span<const int> frames, const ClockStepOptions& options);

}  // namespace canonpose
