// Resection: a camera from joints whose positions in the world are known.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// A keypoint and the position of its joint.
struct Sighting {
  Eigen::Vector3d joint;     ///< in the world, body units
  Eigen::Vector2d keypoint;  ///< normalised image coordinates (observations.h)
};

/// A camera fitted to sightings.
struct Resection {
  bool valid = false;                                      ///< false where the sightings do not determine a camera
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< camera_from_world
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double log_focal = 0.0;
  double cost = 0.0;           ///< mean of Cauchy's loss
  std::vector<double> errors;  ///< of each sighting, body units; infinite behind the camera

  /// The distance between a sighting's keypoint and its projection, in body units at the joint's depth; infinite behind
  /// the camera.
  [[nodiscard]] double ErrorOf(const Sighting& sighting) const;
  /// As the solver holds a static camera.
  [[nodiscard]] CameraEstimate StaticCamera() const;
};

/// The camera of a given focal length that fits the sightings best. Scaled orthography is corrected for perspective
/// until it no longer changes (POSIT; DeMenthon and Davis, IJCV 1995); each iteration is one linear system of all
/// sightings, reweighted by Cauchy's loss so that wrong keypoints count little. `scatter` is the keypoints' usual error
/// in body units. Needs at least six sightings that do not lie in one plane.
Resection Resect(std::span<const Sighting> sightings, double log_focal, double scatter);

/// The same with the focal length found, too: within a factor of two of `expected_log_focal`.
Resection ResectWithFocal(std::span<const Sighting> sightings, double expected_log_focal, double scatter);

}  // namespace canonpose
