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

/// How far triangulated bones are off their lengths, relative; more speaks of swapped joints or of another moment.
inline constexpr double kBoneScatter = 0.1;

/// Cauchy's loss of an error that is given in units of its scatter.
inline double CauchyLoss(double error) { return std::log1p(error * error / (kLossScale * kLossScale)); }

/// How much an error counts under that loss against one that is next to nothing: the loss's derivative by the squared
/// error, times kLossScale^2.
inline double CauchyWeight(double error) { return 1.0 / (1.0 + error * error / (kLossScale * kLossScale)); }

/// How far a point in a camera's frame is from the ray of a keypoint, at the point's depth: in body units, as far as a
/// projection is off. Behind the camera it means nothing; see DistanceInFront().
inline double DistanceAtDepth(const Eigen::Vector3d& in_camera, double focal, const Eigen::Vector2d& keypoint) {
  return (in_camera.head<2>() - keypoint * in_camera.z() / focal).norm();
}

/// The same; NaN behind the camera.
inline double DistanceInFront(const Eigen::Vector3d& in_camera, double focal, const Eigen::Vector2d& keypoint) {
  return in_camera.z() > 0.0 ? DistanceAtDepth(in_camera, focal, keypoint) : std::nan("");
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

/// The scatter of accelerations of each joint (J), a frame^2, along an axis: from second differences of the estimate's
/// joints over one and over three frames. An error that is the same for both gives both the same; motion grows with the
/// square of the step.
std::vector<double> MeasureAccelerations(const CaptureObservations& capture, const RigEstimate& estimate);

/// How fast moving cameras turn, radians a second about an axis (scatter over cameras, runs and time, 0.1 .. 1): from
/// their turning over a second of `frames` (ascending), in which the error of a frame's rotation tells little. The
/// expected turning of AdjustmentScales where no run is as long as half a second. Twice what is measured, since turns
/// come in spurts.
double MeasureAngularVelocity(const CaptureObservations& capture, std::span<const int> frames,
                              const RigEstimate& estimate);

/// Of values of frames: the means of blocks of half a second, since frames near in time are much alike, and the mean of
/// these with its variance.
struct BlockMean {
  int blocks = 0;
  double mean = 0.0;      ///< 0 without blocks
  double variance = 0.0;  ///< of the mean; 0 with fewer than two blocks
};

/// Over the values (one for each of `frames`, ascending) that are finite; no block spans two clips.
BlockMean MeanOverBlocks(const CaptureObservations& capture, std::span<const int> frames,
                         std::span<const double> values);

/// How many standard errors `a` explains the frames better than `b`: of the mean difference of robust errors over
/// blocks of half a second. 0 where there are too few to tell.
double Preference(const CaptureObservations& capture, std::span<const int> frames, const Solution& a,
                  const Solution& b);

/// The standard deviation of a joint along the worst direction, from the views that see it, the lengths of its bones
/// and the joint's smoothness; body units. NaN where the joint is not solved.
double JointUncertainty(const CaptureObservations& capture, int frame, int joint, const Solution& solution);

}  // namespace canonpose
