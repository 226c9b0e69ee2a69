#include "canonpose/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace canonpose {
namespace {

Eigen::Vector2d NotAPoint() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

/// Whether a point lies so far off the axis that the radial distortion has turned back: no lens shows it there.
bool IsBeyondLens(const Eigen::Vector2d& normalised, const std::array<double, 4>& distortion) {
  const auto [k1, k2, p1, p2] = distortion;
  if (k1 >= 0.0 && k2 >= 0.0) return false;
  // r (1 + k1 r^2 + k2 r^4) grows up to the smallest positive root u = r^2 of 1 + 3 k1 u + 5 k2 u^2.
  const double u = normalised.squaredNorm();
  if (k2 == 0.0) return 1.0 + 3.0 * k1 * u <= 0.0;
  const double discriminant = 9.0 * k1 * k1 - 20.0 * k2;
  if (discriminant < 0.0) return false;
  const double root = std::sqrt(discriminant);
  double turn = std::numeric_limits<double>::infinity();
  for (const double candidate : {(-3.0 * k1 + root) / (10.0 * k2), (-3.0 * k1 - root) / (10.0 * k2)}) {
    if (candidate > 0.0) turn = std::min(turn, candidate);
  }
  return u >= turn;
}

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
  const Eigen::Vector2d normalised = point_in_camera.head<2>() / point_in_camera.z();
  if (IsBeyondLens(normalised, distortion)) return NotAPoint();
  const Eigen::Vector2d distorted = Distort(normalised, distortion);
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
