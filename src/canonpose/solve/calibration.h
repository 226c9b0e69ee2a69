// Finding the cameras of a capture, and which of the two mirror solutions is right, from some of its frames.
#pragma once

#include <string>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Evidence for one of the mirror solutions that is called sure, in standard errors.
inline constexpr double kSureSigma = 4.0;

struct CalibrationOptions {
  std::string mirror = "auto";  ///< auto, keep, flip
  int frames = 400;             ///< of a static capture
  int threads = 1;
};

/// The cameras of a static capture and the bone lengths of its subjects, from frames spread evenly over it; joints are
/// set in these frames only. Starts from the lifter's poses: their relative rotations, averaged over all frames.
/// Solution::calibration says whether it succeeded.
Solution CalibrateStatic(const CaptureObservations& capture, const CalibrationOptions& options);

/// The same for moving cameras, from short runs of frames; elsewhere cameras and joints are left as first estimated
/// from the lifter's poses, with the focal lengths that were found.
Solution CalibrateMoving(const CaptureObservations& capture, const CalibrationOptions& options);

/// Frames in which two views at least were lifted.
std::vector<int> FramesWithStart(const CaptureObservations& capture);

}  // namespace canonpose
