#include "canonpose/evaluate/cameras.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "canonpose/base/median.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/geometry/viewing_ray.h"

namespace canonpose {
namespace {

/// The angle between two rotations: |a - b| in the Frobenius norm is sqrt(8) sin(angle / 2).
double AngleDeg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return DegFromRad(2.0 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0))));
}

}  // namespace

void CameraComparison::AddFrame(const Sequence& sequence, int frame) {
  struct Pair {
    Eigen::Matrix3d solved;
    Eigen::Matrix3d truth;
    Eigen::Matrix3d centred_truth;
  };
  std::vector<Pair> before;
  for (const CameraView& view : sequence.cameras) {
    if (view.solved_calibration.empty() || view.calibration.empty()) continue;
    const Camera& solved = view.SolvedCalibrationAt(frame);
    const Camera& truth = view.CalibrationAt(frame);
    focals_percent_.push_back(100.0 * std::abs(solved.K(0, 0) / truth.K(0, 0) - 1.0));
    const Eigen::Vector3d axis = truth.K.inverse() * solved.K.col(2);
    const Pair now{solved.camera_from_world_rotation, truth.camera_from_world_rotation,
                   RotationOntoAxis(axis) * truth.camera_from_world_rotation};
    for (const Pair& other : before) {
      const Eigen::Matrix3d relative = now.solved * other.solved.transpose();
      rotations_deg_.push_back(AngleDeg(relative, now.truth * other.truth.transpose()));
      centred_deg_.push_back(AngleDeg(relative, now.centred_truth * other.centred_truth.transpose()));
    }
    before.push_back(now);
  }
}

void CameraComparison::Add(const Dataset& dataset) {
  for (const Sequence& sequence : dataset.sequences) {
    for (int frame = 0; frame < (sequence.static_cameras ? 1 : sequence.frame_count); ++frame)
      AddFrame(sequence, frame);
  }
}

std::optional<CameraErrors> CameraComparison::Medians() const {
  if (rotations_deg_.empty()) return std::nullopt;
  return CameraErrors{Median(rotations_deg_), Median(centred_deg_), Median(focals_percent_)};
}

}  // namespace canonpose
