// Cameras whose images were of another size than the one declared.
#pragma once

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Looks for views whose keypoints lie as if their images were of another size (data/image_size_check.h), and gives
/// them that size where the cameras and joints then fit the keypoints clearly better. The optical axis is taken to meet
/// the image at its centre, so a wrong size bends the rays of the whole view. Changes `capture`, and calibrates
/// again with `calibrate`: `solution` is its calibration before and after.
void CorrectImageSizes(CaptureObservations& capture, const Calibrate& calibrate, const Calibrate& calibrate_quickly,
                       Solution& solution);

/// Gives the images of a view another size; keypoints keep their pixels.
void SetImageSize(CaptureObservations& capture, int view, const std::array<int, 2>& size_px);

}  // namespace canonpose
