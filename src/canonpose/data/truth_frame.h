// Whether the truth of a dataset is in the camera's frame, as it must be. The keypoints show it.
#pragma once

#include <string>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// How the truth of a view relates to its keypoints. Misfits are root mean square distances between the keypoints and
/// the projected truth, both centred on the root and divided by their norms: 0 is a perfect fit, and unrelated poses
/// have about 1.
struct TruthFrame {
  double misfit = 0.0;             ///< of the truth as it is; NaN where nothing can be compared
  double misfit_from_world = 0.0;  ///< after the calibration's x_in_camera = R x + t; NaN without a calibration
  double misfit_rotated = 0.0;     ///< after the one rotation, the same for all frames, that fits best
  double rotation_deg = 0.0;       ///< the angle of that rotation

  /// The truth contradicts the keypoints as it is, and does not once it is transformed.
  [[nodiscard]] bool is_in_world() const;
  [[nodiscard]] bool is_rotated() const;
};

TruthFrame MeasureTruthFrame(const CameraView& view, int frame_count, const Skeleton& skeleton);

/// Throws Error(kBadInput) naming `file` and the camera where truth is in the world's or another rotated frame.
void RequireTruthInCameraFrame(const Dataset& dataset, const std::string& file);

}  // namespace canonpose
