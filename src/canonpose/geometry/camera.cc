#include "canonpose/geometry/camera.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace canonpose {
namespace {

Eigen::Vector2d NotAPoint() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

/// Whether a point lies so far off the axis that the radial distortion folds back, as no lens does.
bool IsBeyondLens(const Eigen::Vector2d& normalised, const std::array<double, 5>& distortion) {
  const double k1 = distortion[0];
  const double k2 = distortion[1];
  const double k3 = distortion[4];
  if (k1 >= 0.0 && k2 >= 0.0 && k3 >= 0.0) return false;
  // r (1 + k1 r^2 + k2 r^4 + k3 r^6) grows as long as this slope, of u = r^2, stays positive from the axis on.
  const auto slope = [&](double u) { return 1.0 + u * (3.0 * k1 + u * (5.0 * k2 + u * 7.0 * k3)); };
  const double last = normalised.squaredNorm();
  if (slope(last) <= 0.0) return true;
  // Between, it is least where its own derivative 3 k1 + 10 k2 u + 21 k3 u^2 is 0.
  const auto is_turned = [&](double u) { return u > 0.0 && u < last && slope(u) <= 0.0; };
  if (k3 == 0.0) return k2 != 0.0 && is_turned(-0.3 * k1 / k2);
  const double discriminant = 100.0 * k2 * k2 - 252.0 * k1 * k3;
  if (discriminant < 0.0) return false;
  const double root = std::sqrt(discriminant);
  return is_turned((-10.0 * k2 + root) / (42.0 * k3)) || is_turned((-10.0 * k2 - root) / (42.0 * k3));
}

}  // namespace

Eigen::Vector2d Distort(const Eigen::Vector2d& normalised, const std::array<double, 5>& distortion) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double x = normalised.x();
  const double y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Vector2d Camera::ProjectFromCamera(const Eigen::Vector3d& point_in_camera) const {
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
