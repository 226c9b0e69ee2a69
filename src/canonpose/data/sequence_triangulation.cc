#include "canonpose/data/sequence_triangulation.h"

#include <cmath>
#include <limits>
#include <utility>

#include "canonpose/geometry/angles.h"
#include "canonpose/geometry/triangulation.h"

namespace canonpose {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
// Rays that meet at 2 degrees magnify an error across them 30 times along them, which is useless as a reference.
constexpr double kMinRayAngleRad = RadFromDeg(2.0);

PointObservation Observe(const CameraView& view, int frame, std::size_t joint_in_sequence) {
  PointObservation observation;
  if (view.calibration.empty()) return observation;
  observation.camera = &view.CalibrationAt(frame);
  observation.pixel = {view.keypoints[2 * joint_in_sequence], view.keypoints[2 * joint_in_sequence + 1]};
  observation.confidence = view.confidence[joint_in_sequence];
  return observation;
}

}  // namespace

SequencePoses TriangulateSequence(const Sequence& sequence, const Skeleton& skeleton, std::vector<double>* errors_px) {
  const std::size_t joint_count = skeleton.joints.size();
  const std::size_t size = static_cast<std::size_t>(sequence.frame_count) * joint_count;
  std::vector<std::vector<float>> positions;  // by camera, (T, J, 3)
  for (const CameraView& view : sequence.cameras) {
    positions.emplace_back(view.calibration.empty() ? 0 : 3 * size, kUnknown);
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
        positions[c][3 * i + axis] = static_cast<float>(in_camera[static_cast<Eigen::Index>(axis)]);
      }
    }
  }
  SequencePoses poses;
  for (std::size_t c = 0; c < positions.size(); ++c) {
    poses.poses_in_camera.push_back(
        PosesInCamera(skeleton, std::move(positions[c]), LengthUnit::kMillimetres, sequence.cameras[c].name));
  }
  return poses;
}

}  // namespace canonpose
