// A person beside the optical axis is seen from the side. Rotating the viewing ray of the root onto the axis corrects
// for this: the result is what a camera pointed straight at the person would see.
#pragma once

#include <array>

#include <Eigen/Core>

#include "canonpose/geometry/normalisation.h"

namespace canonpose {

/// A camera's intrinsics without distortion: pixel = principal point + focal length * (x / z, y / z).
struct Pinhole {
  Eigen::Vector2d focal_px = Eigen::Vector2d::Zero();  ///< 0 where unknown
  Eigen::Vector2d principal_point_px = Eigen::Vector2d::Zero();

  [[nodiscard]] bool is_known() const { return focal_px.minCoeff() > 0.0; }
  /// A guess for a camera of which only the image size (width, height) is known: the image's diagonal as the focal
  /// length, its centre as the principal point. Unknown where the size is 0.
  static Pinhole Guess(const std::array<int, 2>& image_size);
  static Pinhole FromK(const Eigen::Matrix3d& K);
};

/// The smallest rotation that takes the direction of `ray` (of any length, not opposite to the axis) to (0, 0, 1).
Eigen::Matrix3d RotationOntoAxis(const Eigen::Vector3d& ray);

/// NormalisePose() of what the camera would see if it were turned to have the root on its optical axis:
/// x_in_turned_camera = turned_from_camera * x_in_camera. A joint that would then lie behind the camera counts as
/// missing. An unknown pinhole turns nothing. Returns false, with the results unspecified, where NormalisePose() does.
bool NormalisePoseOnAxis(const float* keypoints, const float* confidence, int joint_count, int root,
                         const Pinhole& pinhole, NormalisedPose& pose, Eigen::Matrix3d& turned_from_camera);

}  // namespace canonpose
