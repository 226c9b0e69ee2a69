// Cameras that do not fit the others: those whose clock is off, and those that show somebody else.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Finds the cameras and joints of a capture from its keypoints; Solution::calibration says whether it succeeded.
using Calibrate = std::function<Solution(const CaptureObservations&)>;

/// What was wrong with the cameras of a capture and has been corrected in its observations.
struct CameraCheck {
  std::vector<std::vector<int>> offsets;  ///< (clips, V) frames by which views were shifted; see ShiftView()
  std::vector<bool> dropped;              ///< (V) whether the view shows something else and was removed
};

/// Shifts the observations of a view in one clip by `frames`: what it saw in frame n, it then sees in frame n + frames.
/// Frames that would come from outside the clip are empty.
void ShiftView(CaptureObservations& capture, int clip, int view, int frames);

/// Removes everything that a view saw.
void DropView(CaptureObservations& capture, int view);

/// The median distance, in body units, between a view's keypoints and the projections of the joints that the other
/// views triangulate, over up to a few hundred frames; with two views, of the joints that both triangulate. NaN where
/// there is nothing to compare. Needs the cameras.
double DisagreementOf(const CaptureObservations& capture, const Solution& solution, int view);

/// Shifts the views of static cameras in time until they fit each other, and drops views that show something else, both
/// in `capture`. Calibrates again after every change: `solution` is the calibration of `capture` before and after. Of
/// two cameras neither is dropped, since nothing says which one is wrong. Stops at the first calibration that fails;
/// `solution` then says so.
CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution);

/// The median distance of all keypoints from the projected joints of a solution, in body units.
double MedianError(const CaptureObservations& capture, const Solution& solution);

}  // namespace canonpose
