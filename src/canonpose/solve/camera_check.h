// Cameras that do not belong: those that show the same person at another time, and those that show somebody else.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Finds cameras and joints of a capture from its keypoints as they are; Solution::calibration says whether it
/// succeeded.
using Calibrate = std::function<Solution(const CaptureObservations&)>;

/// What was found wrong with the cameras of a capture, and mended in its observations.
struct CameraCheck {
  std::vector<std::vector<int>> offsets;  ///< (clips, V) frames that views were moved by; see ShiftView()
  std::vector<bool> dropped;              ///< (V) shows something else, and has no part any more
};

/// Moves the observations of a view in one clip by `frames`: what was seen in frame n is then seen in n + frames.
/// Frames that come from outside the clip show nothing.
void ShiftView(CaptureObservations& capture, int clip, int view, int frames);

/// Removes all that a view saw.
void DropView(CaptureObservations& capture, int view);

/// The median distance of a view's keypoints from where the other views' joints are seen in it, body units, over up to
/// a few hundred frames; with two views, from the joints of both. NaN where nothing can be told. Cameras are known.
double DisagreementOf(const CaptureObservations& capture, const Solution& solution, int view);

/// Shifts views of static cameras in time until they fit, and drops views that do not belong to the others, in
/// `capture`; calibrates again after every change, `solution` being the calibration of the capture as it is. With two
/// cameras none is dropped: nobody knows which. Stops early where a calibration fails, which `solution` then says.
CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution);

/// The median distance of all keypoints from the joints of a solution, body units.
double MedianError(const CaptureObservations& capture, const Solution& solution);

}  // namespace canonpose
