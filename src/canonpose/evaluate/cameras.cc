#include "canonpose/evaluate/cameras.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/median.h"

namespace canonpose {
namespace {

/// The angle between two rotations: |a - b| in the Frobenius norm is sqrt(8) sin(angle / 2).
double AngleDeg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return 2.0 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0))) * 180.0 / M_PI;
}

}  // namespace

void CameraComparison::AddFrame(const Sequence& sequence, int frame) {
  struct Pair {
    Eigen::Matrix3d solved;
    Eigen::Matrix3d truth;
  };
  std::vector<Pair> before;
  for (const CameraView& view : sequence.cameras) {
    if (view.solved_calibration.empty() || view.calibration.empty()) continue;
    const Camera& solved = view.SolvedCalibrationAt(frame);
    const Camera& truth = view.CalibrationAt(frame);
    focals_percent_.push_back(100.0 * std::abs(solved.K(0, 0) / truth.K(0, 0) - 1.0));
    const Pair now{solved.camera_from_world_rotation, truth.camera_from_world_rotation};
    for (const Pair& other : before) {
      rotations_deg_.push_back(AngleDeg(now.solved * other.solved.transpose(), now.truth * other.truth.transpose()));
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
  return CameraErrors{Median(rotations_deg_), Median(focals_percent_)};
}

}  // namespace canonpose
