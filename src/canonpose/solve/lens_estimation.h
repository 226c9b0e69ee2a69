// Finds how the lenses of static cameras distort, where the keypoints show it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Which lens each camera of a capture has (V), numbered from 0: cameras that `same_lens` names together share one, all
/// of them where it is {{"all"}}. Cameras of other captures are passed over.
std::vector<int> LensOfViews(const CaptureObservations& capture,
                             const std::vector<std::vector<std::string>>& same_lens);

/// Finds the lenses together with cameras, bone lengths and joints of some of `frames` (ascending), beginning with
/// `solution`, a calibration of `frames`. If that explains the keypoints better by several standard errors, undistorts
/// the keypoints, calibrates again and returns true. Otherwise capture and solution stay as they are: where keypoints
/// show no distortion, estimates of it would only follow their errors. Nothing is found of cameras that move: zoom and
/// rotation, which are free in every frame, stand for much of what a lens does, and the evidence is not to be trusted.
bool FindLenses(std::span<const int> frames, const std::vector<int>& lens_of_view, const Calibrate& calibrate,
                CaptureObservations& capture, Solution& solution);

}  // namespace canonpose
