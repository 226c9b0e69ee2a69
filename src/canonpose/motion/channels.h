// Shared by the motion capture formats: channels of motion about and along axes, and the conversion from y up to z up.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"

namespace canonpose {

/// One value per frame of a joint: a rotation about or a movement along axis 0, 1 or 2 (x, y, z).
struct Channel {
  bool is_rotation = true;
  int axis = 0;
};

/// Converts a vector from a world with y up to ours with z up: x stays, y becomes z, z becomes -y. This is a proper
/// rotation.
inline Eigen::Vector3d ZUpFromYUp(const Eigen::Vector3d& v) { return {v.x(), -v.z(), v.y()}; }
inline Eigen::Vector3d YUpFromZUp(const Eigen::Vector3d& v) { return {v.x(), v.z(), -v.y()}; }

/// Converts a rotation likewise.
inline Eigen::Quaterniond ZUpFromYUp(const Eigen::Quaterniond& q) { return {q.w(), q.x(), -q.z(), q.y()}; }
inline Eigen::Quaterniond YUpFromZUp(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.z(), -q.y()}; }

/// A factor, since files have millions of angles.
inline constexpr double kRadPerDeg = RadFromDeg(1.0);

/// The rotation about axis 0, 1 or 2 (x, y, z).
inline Eigen::Quaterniond RotationAbout(int axis, double angle_rad) {
  Eigen::Quaterniond rotation(std::cos(angle_rad / 2.0), 0.0, 0.0, 0.0);
  rotation.vec()[axis] = std::sin(angle_rad / 2.0);
  return rotation;
}

}  // namespace canonpose
