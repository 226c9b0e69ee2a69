// Rotations between cameras from the poses that a lifter saw in each of them, averaged so that bad frames count little.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/geometry/points.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// The angle between two rotations, 0 .. pi.
double RotationAngle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// A mean rotation, and how far the samples lie from it.
struct MeanRotation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double weight = 0.0;          ///< sum of the weights of the samples; 0: there were none
  double median_angle_rad = 0;  ///< of the samples from the mean
};

/// The rotation whose weighted sum of angles to the samples is about least: chordal means (the nearest rotation to the
/// weighted sum), reweighted by 1 / max(angle, 5 degrees) ten times (Hartley et al. 2013).
MeanRotation RobustMean(std::span<const Eigen::Matrix3d> samples, std::span<const double> weights);

/// The rotation that takes the pose in view `from` to that in view `to`, both (J, 3) root-centred.
Eigen::Matrix3d AlignRotation(const Points3d& from, const Points3d& to);

/// camera_from_world rotations (V) of cameras from relative ones, camera_from_camera[to][from], the world being the
/// frame of the camera with the most evidence: a spanning tree of the heaviest pairs, then 50 rounds of averaging over
/// all pairs. Cameras that no pair reaches keep a NaN rotation.
std::vector<Eigen::Matrix3d> SynchroniseRotations(const std::vector<std::vector<MeanRotation>>& camera_from_camera);

/// camera_from_world (V) of a static capture, from all frames; `spread` gives the relative rotations' scatter.
struct StaticRotations {
  std::vector<Eigen::Matrix3d> camera_from_world;
  std::vector<std::vector<MeanRotation>> pairs;  ///< [to][from]
};
StaticRotations AverageStaticRotations(const CaptureObservations& capture, std::span<const int> frames);

/// camera_from_world (F, V) of moving cameras: relative rotations averaged over the frames within `window_seconds`
/// before and after, of the same clip; the world of each frame is the frame of one camera, the same throughout. NaN
/// where no view within reach was lifted.
std::vector<std::vector<Eigen::Matrix3d>> SmoothedRotations(const CaptureObservations& capture, double window_seconds);

}  // namespace canonpose
