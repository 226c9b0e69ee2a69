// From a solution back to the dataset: poses, their uncertainties and cameras.
#pragma once

#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Sets `solved` and `solved_calibration` of the capture's views, and their `time_offset_seconds` or `solved_frames`.
/// Every view keeps its own time and frames, which `clocks` (clips, V) takes to those of the capture; keypoints of
/// views that `check` found mirrored, with left and right exchanged or of another image size are written as they should
/// be, so that the solved cameras project the solved poses to them.
///
/// A joint that no view sees in a frame is written only where views see it within a tenth of a second before and after,
/// and then with confidence 0.
void WriteSolution(const CaptureObservations& capture, const Solution& solution, const CameraCheck& check,
                   const std::vector<std::vector<TimeMap>>& clocks, Dataset& dataset);

/// For a capture that was not solved: missing joints where poses would be.
void WriteNothing(const CaptureObservations& capture, Dataset& dataset);

}  // namespace canonpose
