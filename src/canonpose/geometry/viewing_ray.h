// A pose that stands beside the optical axis is seen from the side. Turning the viewing ray of its root onto the axis
// takes that away: what is left is what a camera that looks straight at the person would see.
#pragma once

#include <array>

#include <Eigen/Core>

#include "canonpose/geometry/normalisation.h"

namespace canonpose {

/// A camera's intrinsics without distortion: pixel = principal point + focal length * (x / z, y / z).
struct Pinhole {
  Eigen::Vector2d focal_px = Eigen::Vector2d::Zero();  ///< 0: not known
  Eigen::Vector2d principal_point_px = Eigen::Vector2d::Zero();

  [[nodiscard]] bool is_known() const { return focal_px.minCoeff() > 0.0; }
  /// What is guessed of a camera of which nothing but the image size (width, height) is known: its diagonal as the
  /// focal length, its middle as the principal point. Not known where the size is 0.
  static Pinhole Guess(const std::array<int, 2>& image_size);
  static Pinhole FromK(const Eigen::Matrix3d& K);
};

/// The least rotation that takes the direction of `ray` (any length, not opposite to the axis) to (0, 0, 1).
Eigen::Matrix3d RotationOntoAxis(const Eigen::Vector3d& ray);

/// NormalisePose() of what a camera sees that is turned to have the root on its optical axis:
/// x_in_turned_camera = turned_from_camera * x_in_camera. A joint that would then lie behind the camera counts as
/// missing. A pinhole that is not known turns nothing. Returns false, the results unspecified, as NormalisePose() does.
bool NormalisePoseOnAxis(const float* keypoints, const float* confidence, int joint_count, int root,
                         const Pinhole& pinhole, NormalisedPose& pose, Eigen::Matrix3d& turned_from_camera);

}  // namespace canonpose
