#include "canonpose/evaluate/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/geometry/triangulation.h"

namespace canonpose {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
// Two rays at 2 degrees make 30 times as much of an error along them as across: no reference any more.
constexpr double kMinRayAngleRad = 2.0 * 3.14159265358979 / 180.0;

PointObservation Observe(const CameraView& view, int frame, std::size_t joint_in_sequence) {
  PointObservation observation;
  if (view.calibration.empty()) return observation;
  observation.camera = &view.CalibrationAt(frame);
  observation.pixel = {view.keypoints[2 * joint_in_sequence], view.keypoints[2 * joint_in_sequence + 1]};
  observation.confidence = view.confidence[joint_in_sequence];
  return observation;
}

}  // namespace

SequenceReference TriangulateSequence(const Sequence& sequence, int joints, std::vector<double>* errors_px) {
  const auto joint_count = static_cast<std::size_t>(joints);
  SequenceReference reference;
  const std::size_t size = static_cast<std::size_t>(sequence.frame_count) * joint_count;
  for (const CameraView& view : sequence.cameras) {
    reference.poses_in_camera.emplace_back(view.calibration.empty() ? 0 : 3 * size, kUnknown);
  }
  std::vector<PointObservation> observations(sequence.cameras.size());
  for (std::size_t i = 0; i < size; ++i) {
    const auto frame = static_cast<int>(i / joint_count);
    for (std::size_t c = 0; c < observations.size(); ++c) observations[c] = Observe(sequence.cameras[c], frame, i);
    const TriangulatedPoint point = Triangulate(observations);
    if (!point.valid() || !point.in_front_of_all_cameras || point.largest_ray_angle_rad < kMinRayAngleRad) continue;
    for (std::size_t c = 0; c < observations.size(); ++c) {
      if (sequence.cameras[c].calibration.empty()) continue;
      const PointObservation& seen = observations[c];
      const double error_px = (seen.camera->Project(point.point_in_world_mm) - seen.pixel).norm();
      if (errors_px != nullptr && seen.confidence > 0.0 && std::isfinite(error_px)) errors_px->push_back(error_px);
      const Eigen::Vector3d in_camera = sequence.cameras[c].CalibrationAt(frame).InCamera(point.point_in_world_mm);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        reference.poses_in_camera[c][3 * i + axis] = static_cast<float>(in_camera[static_cast<Eigen::Index>(axis)]);
      }
    }
  }
  return reference;
}

ReferencePoses::ReferencePoses(const Dataset& dataset, const std::string& file) {
  const bool has_truth = dataset.HasTruth();
  if (!has_truth && !dataset.HasCalibration()) {
    ThrowBadInput({file, "", "truth or a calibration to evaluate against", "neither",
                   "import the data with `calibration`, or evaluate other data"});
  }
  triangulated_ = !has_truth;
  for (const Sequence& sequence : dataset.sequences) {
    if (triangulated_) {
      sequences_.push_back(TriangulateSequence(sequence, dataset.skeleton.joint_count(), &reprojection_errors_px_));
      continue;
    }
    SequenceReference reference;
    for (const CameraView& view : sequence.cameras) reference.poses_in_camera.push_back(view.truth);
    sequences_.push_back(std::move(reference));
  }
}

void ReferenceSummary::Add(const ReferencePoses& reference) {
  (reference.triangulated() ? any_triangulated_ : any_truth_) = true;
  reprojection_errors_px_.insert(reprojection_errors_px_.end(), reference.reprojection_errors_px().begin(),
                                 reference.reprojection_errors_px().end());
}

ReferenceKind ReferenceSummary::Kind() const {
  ReferenceKind kind;
  kind.description = "truth";
  if (!any_triangulated_) return kind;
  kind.description = any_truth_ ? "truth in some files, in others triangulated from the calibration"
                                : "triangulated from the calibration";
  if (reprojection_errors_px_.empty()) return kind;
  const double sum = std::accumulate(reprojection_errors_px_.begin(), reprojection_errors_px_.end(), 0.0);
  kind.reprojection_px = {Median(reprojection_errors_px_), sum / static_cast<double>(reprojection_errors_px_.size())};
  return kind;
}

}  // namespace canonpose
