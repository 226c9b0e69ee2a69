#include "canonpose/evaluate/cameras.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "canonpose/base/median.h"
#include "canonpose/evaluate/camera_alignment.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/geometry/viewing_ray.h"

namespace canonpose {
namespace {

/// The angle between two rotations: |a - b| in the Frobenius norm is sqrt(8) sin(angle / 2).
double AngleDeg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return DegFromRad(2.0 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0))));
}

/// Of an image whose optical axis is in its middle. Where a lens's distortion has no inverse at the edge, that of the
/// same lens without distortion.
double VerticalFovDeg(const Camera& camera, int image_height_px) {
  const double half_height_px = 0.5 * image_height_px;
  const Eigen::Vector2d edge_px(camera.K(0, 2), camera.K(1, 2) + half_height_px);
  const double tangent = camera.Undistort(edge_px).y();
  return DegFromRad(2.0 * std::atan(std::isfinite(tangent) ? tangent : half_height_px / camera.K(1, 1)));
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

void CameraComparison::AddFrame(const Sequence& sequence, int frame) {
  struct Pair {
    Eigen::Matrix3d solved;
    Eigen::Matrix3d truth;
    Eigen::Matrix3d centred_truth;
  };
  std::vector<Pair> before;
  CameraPairs pairs;
  bool is_metric = true;
  for (const CameraView& view : sequence.cameras) {
    if (view.solved_calibration.empty() || view.calibration.empty()) continue;
    const Camera& solved = view.SolvedCalibrationAt(frame);
    const Camera& truth = view.CalibrationAt(frame);
    focals_percent_.push_back(100.0 * std::abs(solved.K(0, 0) / truth.K(0, 0) - 1.0));
    const int height_px = view.image_size[1];
    fovs_deg_.push_back(std::abs(VerticalFovDeg(solved, height_px) - VerticalFovDeg(truth, height_px)));
    pairs.Add(solved, truth);
    is_metric = is_metric && view.solved.unit == LengthUnit::kMillimetres;
    const Eigen::Vector3d axis = truth.Undistort(solved.K.col(2).head<2>()).homogeneous();
    const Pair now{solved.camera_from_world_rotation, truth.camera_from_world_rotation,
                   RotationOntoAxis(axis) * truth.camera_from_world_rotation};
    for (const Pair& other : before) {
      const Eigen::Matrix3d relative = now.solved * other.solved.transpose();
      rotations_deg_.push_back(AngleDeg(relative, now.truth * other.truth.transpose()));
      centred_deg_.push_back(AngleDeg(relative, now.centred_truth * other.centred_truth.transpose()));
    }
    before.push_back(now);
  }
  if (pairs.size() >= 2 && is_metric) translations_mm_.push_back(pairs.MeanDistance(pairs.Rigid()));
  if (pairs.size() >= 3) scaled_translations_mm_.push_back(pairs.MeanDistance(pairs.WithScale()));
}

void CameraComparison::Add(const Dataset& dataset) {
  for (const Sequence& sequence : dataset.sequences) {
    for (int frame = 0; frame < (sequence.static_cameras ? 1 : sequence.frame_count); ++frame)
      AddFrame(sequence, frame);
  }
}

std::optional<CameraErrors> CameraComparison::Medians() const {
  if (rotations_deg_.empty()) return std::nullopt;
  CameraErrors errors;
  errors.relative_rotation_deg = Median(rotations_deg_);
  errors.centred_rotation_deg = Median(centred_deg_);
  errors.focal_percent = Median(focals_percent_);
  errors.angle_deg = Mean(rotations_deg_);
  errors.vertical_fov_deg = Mean(fovs_deg_);
  if (!translations_mm_.empty()) errors.translation_mm = Mean(translations_mm_);
  if (!scaled_translations_mm_.empty()) errors.scaled_translation_mm = Mean(scaled_translations_mm_);
  return errors;
}

}  // namespace canonpose
