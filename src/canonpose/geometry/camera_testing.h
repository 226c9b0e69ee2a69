// For tests only: cameras around a scene.
#pragma once

#include <Eigen/Geometry>

#include "canonpose/geometry/camera.h"

namespace canonpose::testing {

/// A camera `distance_mm` from the origin at the given bearing, looking at it.
inline Camera CameraAround(double bearing_rad, double distance_mm) {
  Camera camera;
  camera.K << 1100.0, 0.0, 500.0, 0.0, 1100.0, 480.0, 0.0, 0.0, 1.0;
  camera.camera_from_world_rotation = Eigen::AngleAxisd(bearing_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.camera_from_world_translation = {0.0, 0.0, distance_mm};
  camera.distortion = {-0.05, 0.12, 0.001, -0.0007};
  return camera;
}

}  // namespace canonpose::testing
