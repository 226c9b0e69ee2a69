#include "canonpose/simulate/rig_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// Barrel distortion at the corner of a wide lens of strength 1, as a fraction of the radius: k1 is about -0.25 where
/// the diagonal field of view is 85 degrees. The quartic term compensates 30 % of it there. The derivative of the
/// distorted radius, 1 - 0.6 s u + 0.3 s u^2 with u = (r / corner)^2, stays positive for every strength s < 3.3.
constexpr double kWideCornerDistortion = -0.20;
constexpr double kQuarticShare = -0.30;
/// Tangent of half the diagonal field of view above which a lens counts as wide; longer lenses distort less.
constexpr double kWideCornerTangent = 0.9;
constexpr double kTangentialAtCorner = 0.002;

double CornerTangent(std::array<int, 2> image_size, double focal_px) {
  return std::hypot(image_size[0], image_size[1]) / 2.0 / focal_px;
}

}  // namespace

void Lens::Apply(double focal_px, Camera& camera) const {
  camera.K << focal_px, 0.0, principal_point_px.x(),  //
      0.0, focal_px * pixel_aspect, principal_point_px.y(), 0.0, 0.0, 1.0;
  const double corner = CornerTangent(image_size, focal_px);
  const double wide = std::min(1.0, corner / kWideCornerTangent);
  const double corner2 = corner * corner;
  camera.distortion = {wide * corner_distortion[0] / corner2, wide * corner_distortion[1] / (corner2 * corner2),
                       wide * tangential[0] / corner, wide * tangential[1] / corner};
}

Lens MakeLens(std::array<int, 2> image_size, double distortion, Rng& rng) {
  Lens lens;
  lens.image_size = image_size;
  const double off_centre_px = 0.01 * std::max(image_size[0], image_size[1]);
  lens.principal_point_px.x() = image_size[0] / 2.0 + off_centre_px * std::clamp(rng.Normal(), -2.0, 2.0);
  lens.principal_point_px.y() = image_size[1] / 2.0 + off_centre_px * std::clamp(rng.Normal(), -2.0, 2.0);
  lens.pixel_aspect = 1.0 + 0.001 * rng.Normal();
  const double corner = distortion * rng.Uniform(0.8, 1.2) * kWideCornerDistortion;
  lens.corner_distortion = {corner, kQuarticShare * corner};
  lens.tangential[0] = distortion * kTangentialAtCorner * rng.Normal();
  lens.tangential[1] = distortion * kTangentialAtCorner * rng.Normal();
  return lens;
}

void Aim(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& target_mm, double roll_rad, Camera& camera) {
  const Eigen::Vector3d forward = (target_mm - position_mm).normalized();
  // Straight up or down there is no horizon, so any roll will do.
  const bool is_vertical = std::abs(forward.z()) > 1.0 - 1e-9;
  const Eigen::Vector3d up = is_vertical ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  const Eigen::Vector3d down = forward.cross(right);
  const double c = std::cos(roll_rad);
  const double s = std::sin(roll_rad);
  camera.camera_from_world_rotation.row(0) = (c * right + s * down).transpose();
  camera.camera_from_world_rotation.row(1) = (c * down - s * right).transpose();
  camera.camera_from_world_rotation.row(2) = forward.transpose();
  camera.camera_from_world_translation = -camera.camera_from_world_rotation * position_mm;
}

std::vector<double> Azimuths(const std::string& spread, int count, Rng& rng) {
  const double first = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  const double step = 2.0 * std::numbers::pi / count;
  std::vector<double> azimuths;
  // Cameras spread over the arc from end to end, so that two over a quarter are nearly 90 degrees apart. None leaves
  // the arc.
  const auto within = [&](double arc_degrees) {
    constexpr double kMargin = 0.04;
    for (int i = 0; i < count; ++i) {
      const double share = kMargin + (1.0 - 2.0 * kMargin) * i / std::max(1, count - 1);
      azimuths.push_back(first + RadFromDeg(arc_degrees) * (share + rng.Uniform(-kMargin, kMargin)));
    }
  };
  if (spread == "even") {
    for (int i = 0; i < count; ++i) azimuths.push_back(first + step * (i + rng.Uniform(-0.12, 0.12)));
  } else if (spread == "opposite") {
    for (int i = 0; i < count; ++i) {
      azimuths.push_back(first + (i % 2) * std::numbers::pi + RadFromDeg(rng.Uniform(-10.0, 10.0)));
    }
  } else if (spread == "quarter") {
    within(90.0);
  } else if (spread == "clustered") {
    within(30.0);
  } else {
    ThrowInvalidArgument("there is no `spread` {}; choose even, opposite, quarter or clustered", spread);
  }
  return azimuths;
}

}  // namespace canonpose
