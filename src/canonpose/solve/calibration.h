// Finds the cameras of a capture from some of its frames, and decides the depth-reversal ambiguity, that is, between
// the solution and its mirror.
#pragma once

#include <string>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// The evidence, in standard errors, from which on it decides between a solution and its mirror.
inline constexpr double kDecisiveSigma = 4.0;

/// The focal length of a wide lens, in image diagonals: 95 degrees from corner to corner.
inline constexpr double kWideLens = 0.45;

struct CalibrationOptions {
  std::string mirror = "auto";  ///< auto, keep or flip; see SolveOptions (solver.h)
  int frames = 400;             ///< of a static capture
  int threads = 1;
  int max_iterations = 100;  ///< of the bundle adjustment of a static capture
  double first_focal = 1.0;  ///< of all cameras of a static capture, to begin with, in image diagonals
};

/// Finds the cameras of a static capture and the bone lengths of its subjects from evenly spread frames, and sets the
/// joints of these frames only. Begins with the relative rotations of the start's poses, averaged over the capture.
/// Solution::calibration says whether it succeeded.
Solution CalibrateStatic(const CaptureObservations& capture, const CalibrationOptions& options);

/// The same for moving cameras, from short runs of frames. In all other frames cameras and joints keep the first
/// estimate from the start's poses, but with the focal lengths found in the runs.
Solution CalibrateMoving(const CaptureObservations& capture, const CalibrationOptions& options);

/// The frames that a calibration adjusts.
std::vector<int> CalibrationFrames(const CaptureObservations& capture, const CalibrationOptions& options);

/// The frames in which at least two views have a start pose.
std::vector<int> FramesWithStart(const CaptureObservations& capture);

}  // namespace canonpose
