// What the capture formats share: channels of motion about and along axes, and the turn from y up to z up.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"

namespace canonpose {

/// One number of a joint a frame: a rotation about or a movement along axis 0, 1 or 2 (x, y, z).
struct Channel {
  bool is_rotation = true;
  int axis = 0;
};

/// A vector of a world with y up in ours with z up: x stays, y becomes z, z becomes -y. A proper rotation.
inline Eigen::Vector3d ZUpFromYUp(const Eigen::Vector3d& v) { return {v.x(), -v.z(), v.y()}; }
inline Eigen::Vector3d YUpFromZUp(const Eigen::Vector3d& v) { return {v.x(), v.z(), -v.y()}; }

/// The same rotation, its axis turned along.
inline Eigen::Quaterniond ZUpFromYUp(const Eigen::Quaterniond& q) { return {q.w(), q.x(), -q.z(), q.y()}; }
inline Eigen::Quaterniond YUpFromZUp(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.z(), -q.y()}; }

/// A factor, since files have millions of angles.
inline constexpr double kRadPerDeg = RadFromDeg(1.0);

inline Eigen::Quaterniond RotationAbout(int axis, double angle_rad) {
  Eigen::Quaterniond rotation(std::cos(angle_rad / 2.0), 0.0, 0.0, 0.0);
  rotation.vec()[axis] = std::sin(angle_rad / 2.0);
  return rotation;
}

}  // namespace canonpose
