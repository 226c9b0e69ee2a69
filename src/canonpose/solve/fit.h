// How well an estimate explains what the cameras saw.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/noise_model.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/rig_estimate.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Relative error of triangulated bones' lengths. Larger errors suggest swapped joints or views of different moments.
inline constexpr double kBoneScatter = 0.1;

/// Cauchy's loss of an error in units of its scatter.
inline double CauchyLoss(double error) { return std::log1p(error * error / (kLossScale * kLossScale)); }

/// The weight of an error under that loss, 1 for an error of 0: the derivative of the loss with respect to the squared
/// error, times kLossScale^2.
inline double CauchyWeight(double error) { return 1.0 / (1.0 + error * error / (kLossScale * kLossScale)); }

/// A point in a camera's frame less the point of a keypoint's ray at its depth: the reprojection error in body units,
/// as a vector along the image's axes. Meaningless behind the camera; see DistanceInFront().
inline Eigen::Vector2d DisplacementAtDepth(const Eigen::Vector3d& in_camera, double focal,
                                           const Eigen::Vector2d& keypoint) {
  return in_camera.head<2>() - keypoint * in_camera.z() / focal;
}

/// The length of that vector.
inline double DistanceAtDepth(const Eigen::Vector3d& in_camera, double focal, const Eigen::Vector2d& keypoint) {
  return DisplacementAtDepth(in_camera, focal, keypoint).norm();
}

/// The same; NaN behind the camera.
inline double DistanceInFront(const Eigen::Vector3d& in_camera, double focal, const Eigen::Vector2d& keypoint) {
  return in_camera.z() > 0.0 ? DistanceAtDepth(in_camera, focal, keypoint) : std::nan("");
}

/// The derivative of that vector, (x, y)_in_camera - keypoint z_in_camera / focal, by a point in the world, where the
/// keypoint is that of the point itself.
inline Eigen::Matrix<double, 2, 3> ProjectionRows(const Eigen::Matrix3d& camera_from_world,
                                                  const Eigen::Vector3d& in_camera) {
  return camera_from_world.topRows<2>() - in_camera.head<2>() / in_camera.z() * camera_from_world.row(2);
}

/// The variance along an axis of the image, at the point's depth, of a point whose covariance in the world is given.
inline double VarianceInView(const Eigen::Matrix3d& camera_from_world, const Eigen::Vector3d& in_camera,
                             const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix<double, 2, 3> rows = ProjectionRows(camera_from_world, in_camera);
  return 0.5 * (rows * covariance * rows.transpose()).trace();
}

/// Calls visit(frame, view, joint, error) for every keypoint that the estimate explains; the error is the distance in
/// body units.
template <typename Visit>
void VisitErrors(const CaptureObservations& capture, std::span<const int> frames, const RigEstimate& estimate,
                 Visit&& visit) {
  for (const int frame : frames) {
    for (int v = 0; v < capture.view_count(); ++v) {
      if (!estimate.CameraAt(frame, v).valid) continue;
      const double scale = estimate.ImageScale(frame, v, capture.skeleton.root);
      for (int j = 0; j < capture.joint_count(); ++j) {
        if (!capture.Sees(frame, v, j) || !estimate.Joint(frame, j).allFinite()) continue;
        const double error = (estimate.Project(frame, v, j) - capture.At(frame, v, j)).norm() / scale;
        if (std::isfinite(error)) visit(frame, v, j, error);
      }
    }
  }
}

NoiseModel MeasureNoise(const CaptureObservations& capture, std::span<const int> frames, const RigEstimate& estimate);

/// The scatter of each joint's acceleration along an axis (J), body units per frame^2, from second differences of the
/// joints over steps of one and of three frames: errors of the joints add the same to both, whereas motion grows with
/// the square of the step.
std::vector<double> MeasureAccelerations(const CaptureObservations& capture, const RigEstimate& estimate);

/// How fast moving cameras rotate about an axis, radians per second (scatter over cameras, runs and time, at least 0.1
/// and at most 1): from their rotation over one second of `frames` (ascending), against which the error of a single
/// frame's rotation is small. Twice what is measured, since cameras rotate in bursts. Where no run lasts half a second,
/// the default of AdjustmentScales.
double MeasureAngularVelocity(const CaptureObservations& capture, std::span<const int> frames,
                              const RigEstimate& estimate);

/// The mean of values of frames and its variance, computed from the means of blocks of half a second, since frames
/// close in time are alike.
struct BlockMean {
  int blocks = 0;
  double mean = 0.0;      ///< 0 without blocks
  double variance = 0.0;  ///< of the mean; 0 with fewer than two blocks
};

/// Of the finite ones of `values`, one per element of `frames` (ascending). No block spans two clips.
BlockMean MeanOverBlocks(const CaptureObservations& capture, std::span<const int> frames,
                         std::span<const double> values);

/// How much better `a` explains the frames than `b`: the mean difference of their robust errors in standard errors
/// (MeanOverBlocks). Negative where `b` is better; 0 where there are fewer than two blocks.
double Preference(const CaptureObservations& capture, std::span<const int> frames, const Solution& a,
                  const Solution& b);

/// A solution and the keypoints that it explains.
struct Explanation {
  const CaptureObservations& capture;
  const Solution& solution;
};

/// The same of solutions to different readings of the same keypoints, such as undistorted ones.
double Preference(const Explanation& a, const Explanation& b, std::span<const int> frames);

}  // namespace canonpose
