// Pinhole cameras with Brown-Conrady distortion.
#pragma once

#include <array>

#include <Eigen/Core>

namespace canonpose {

/// x_in_camera = rotation * x_in_world + translation; pixel = K * Distort(x_in_camera / z). x right, y down, z forward.
/// The translation has the unit of the points: millimetres for a camera that was calibrated or simulated, otherwise the
/// unit that the camera's owner documents.
struct Camera {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d camera_from_world_rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera_from_world_translation = Eigen::Vector3d::Zero();
  std::array<double, 5> distortion{0.0, 0.0, 0.0, 0.0, 0.0};  ///< k1, k2, p1, p2, k3 (OpenCV's order)

  [[nodiscard]] Eigen::Vector3d InCamera(const Eigen::Vector3d& point_in_world) const {
    return camera_from_world_rotation * point_in_world + camera_from_world_translation;
  }
  /// The pixel of a point; NaN where it lies behind the camera, or so far off the axis that the distortion model folds
  /// back.
  [[nodiscard]] Eigen::Vector2d Project(const Eigen::Vector3d& point_in_world) const {
    return ProjectFromCamera(InCamera(point_in_world));
  }
  /// The same for a point in the camera's frame.
  [[nodiscard]] Eigen::Vector2d ProjectFromCamera(const Eigen::Vector3d& point_in_camera) const;
  /// Normalised, undistorted image coordinates (x/z, y/z) of a pixel, by fixed-point iteration to 1e-12. NaN for a NaN
  /// pixel, and for a pixel so far out that the distortion has no inverse there.
  [[nodiscard]] Eigen::Vector2d Undistort(const Eigen::Vector2d& pixel) const;
};

/// Applies distortion to normalised image coordinates, by OpenCV's formula with k1, k2, p1, p2, k3.
Eigen::Vector2d Distort(const Eigen::Vector2d& normalised, const std::array<double, 5>& distortion);

}  // namespace canonpose
