// Cameras that do not fit the others: what is wrong with them is found, corrected where that is certain, and left out
// otherwise.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

/// Finds the cameras and joints of a capture from its keypoints; Solution::calibration says whether it succeeded.
using Calibrate = std::function<Solution(const CaptureObservations&)>;

/// What was wrong with the cameras of a capture and has been corrected in its observations.
struct CameraCheck {
  std::vector<std::vector<ViewCorrection>> corrections;  ///< (clips, V)
  std::vector<bool> dropped;                             ///< (V) whether the view was left out as a whole
  std::vector<std::string> why_dropped;                  ///< (V) in words that follow the camera's name
  std::vector<std::string> dropped_as;                   ///< (V) CameraFinding::kind

  explicit CameraCheck(const CaptureObservations& capture)
      : corrections(capture.clips.size(), std::vector<ViewCorrection>(capture.cameras.size())),
        dropped(capture.cameras.size(), false),
        why_dropped(capture.cameras.size()),
        dropped_as(capture.cameras.size()) {}
  [[nodiscard]] ViewCorrection& At(int clip, int view) {
    return corrections[static_cast<std::size_t>(clip)][static_cast<std::size_t>(view)];
  }
  [[nodiscard]] const ViewCorrection& At(int clip, int view) const {
    return const_cast<CameraCheck*>(this)->At(clip, view);
  }
};

/// Shifts the observations of a view in one clip by `frames`: what it saw in frame n, it then sees in frame n + frames.
/// Frames that would come from outside the clip are empty.
void ShiftView(CaptureObservations& capture, int clip, int view, int frames);

/// Removes everything that a view saw.
void DropView(CaptureObservations& capture, int view);

/// Looks for views that do not fit the others and corrects `capture`: views of static cameras are shifted in time;
/// images that are mirrored, exchange left and right, or run at another rate are read as they should be; stretches of
/// time that do not fit are left out, and so are views of which nothing fits. Calibrates again after every change:
/// `solution` is the calibration of `capture` before and after. Of two cameras neither is left out, since nothing says
/// which one is wrong. Stops at the first calibration that fails; `solution` then says so.
/// `calibrate_quickly` finds out which views agree; it may be less exact.
CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, const Calibrate& calibrate_quickly,
                         Solution& solution);

/// The median distance of all keypoints from the projected joints of a solution, in body units.
double MedianError(const CaptureObservations& capture, const Solution& solution);

/// The mean of the same distances, each counted as 0.03 at most: unlike the median, it shows that one view of many is
/// wrong.
double CappedError(const CaptureObservations& capture, const Solution& solution);

/// Whether a solution is usable and its CappedError() less than `gain` times that of another, if the other is usable.
bool FitsBetter(const CaptureObservations& capture, const Solution& solution, const Solution& other, double gain = 1.0);

}  // namespace canonpose
