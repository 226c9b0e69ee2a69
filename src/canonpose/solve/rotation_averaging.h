// Rotations between cameras from the start's poses of each view, averaged so that bad frames count little.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/geometry/points.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// The angle between two rotations, 0 .. pi.
double RotationAngle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// A mean rotation and the spread of its samples.
struct MeanRotation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double weight = 0.0;          ///< sum of the samples' weights; 0 without samples
  double median_angle_rad = 0;  ///< between the samples and the mean
};

/// The rotation that approximately minimises the weighted sum of angles to the samples: chordal means (the rotation
/// nearest to the weighted sum), reweighted ten times by 1 / max(angle, 5 degrees) (Hartley et al. 2013).
MeanRotation RobustMean(std::span<const Eigen::Matrix3d> samples, std::span<const double> weights);

/// The rotation that takes the pose in view `from` to that in view `to`, both (J, 3) root-centred.
Eigen::Matrix3d AlignRotation(const Points3d& from, const Points3d& to);

/// camera_from_world rotations (V) from relative ones, camera_from_camera[to][from]. The world is the frame of the
/// camera whose pairs have most weight. A spanning tree of the heaviest pairs gives a start, 50 rounds of averaging
/// over all pairs refine it. The rotations of cameras that no pair connects are NaN.
std::vector<Eigen::Matrix3d> SynchroniseRotations(const std::vector<std::vector<MeanRotation>>& camera_from_camera);

/// The rotations of static cameras.
struct StaticRotations {
  std::vector<Eigen::Matrix3d> camera_from_world;  ///< (V)
  std::vector<std::vector<MeanRotation>> pairs;    ///< [to][from] what they were found from
};
/// Averages over `frames`.
StaticRotations AverageStaticRotations(const CaptureObservations& capture, std::span<const int> frames);

/// camera_from_world (F, V) of moving cameras: relative rotations are averaged over the frames of the clip within
/// `window_seconds` before and after. The world of each frame is chosen so that all cameras together rotate as little
/// as possible from one frame to the next. NaN where no view has a start pose that near.
std::vector<std::vector<Eigen::Matrix3d>> SmoothedRotations(const CaptureObservations& capture, double window_seconds);

}  // namespace canonpose
