#include "canonpose/geometry/camera.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace canonpose {
namespace {

Eigen::Vector2d NotAPoint() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

}  // namespace

Eigen::Vector2d Distort(const Eigen::Vector2d& normalised, const std::array<double, 4>& distortion) {
  const auto [k1, k2, p1, p2] = distortion;
  const double x = normalised.x();
  const double y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + k1 * r2 + k2 * r2 * r2;
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Vector2d Camera::Project(const Eigen::Vector3d& point_in_world_mm) const {
  const Eigen::Vector3d point_in_camera = InCamera(point_in_world_mm);
  if (!(point_in_camera.z() > 0.0)) return NotAPoint();
  const Eigen::Vector2d distorted = Distort(point_in_camera.head<2>() / point_in_camera.z(), distortion);
  return (K * distorted.homogeneous()).hnormalized();
}

Eigen::Vector2d Camera::Undistort(const Eigen::Vector2d& pixel) const {
  constexpr int kMaxIterations = 500;
  constexpr double kTolerance = 1e-12;
  const Eigen::Vector2d distorted = (K.inverse() * pixel.homogeneous()).hnormalized();
  Eigen::Vector2d normalised = distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d error = distorted - Distort(normalised, distortion);
    if (!error.allFinite()) return NotAPoint();
    if (error.cwiseAbs().maxCoeff() < kTolerance) return normalised;
    normalised += error;
  }
  return NotAPoint();
}

}  // namespace canonpose
