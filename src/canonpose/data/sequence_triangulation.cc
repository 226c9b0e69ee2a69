#include "canonpose/data/sequence_triangulation.h"

#include <algorithm>
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

/// Whether `solve` left out what a view shows in its own frame `frame`, as it does where a view does not fit the
/// others.
bool IsLeftOut(const Sequence& sequence, const CameraView& view, int frame) {
  const auto knows_any = [](const PoseSequence& poses, int t) {
    return t < poses.frame_count() && poses.PoseAt(t).array().isFinite().any();
  };
  if (view.solved.empty() || knows_any(view.solved, frame)) return false;
  return std::ranges::any_of(sequence.cameras, [&](const CameraView& other) { return knows_any(other.solved, frame); });
}

/// What a view shows in its own frame `frame`; nothing where that is -1.
PointObservation Observe(const Sequence& sequence, const CameraView& view, int frame, std::size_t joint,
                         std::size_t joint_count) {
  PointObservation observation;
  if (view.calibration.empty() || frame < 0) return observation;
  observation.camera = &view.CalibrationAt(frame);
  if (IsLeftOut(sequence, view, frame)) return observation;
  const std::size_t i = static_cast<std::size_t>(frame) * joint_count + joint;
  observation.pixel = {view.keypoints[2 * i], view.keypoints[2 * i + 1]};
  observation.confidence = view.confidence[i];
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
  int first = 0;
  int last = sequence.frame_count - 1;
  std::vector<ViewClock> clocks;
  for (const CameraView& view : sequence.cameras) {
    const ViewClock& clock = clocks.emplace_back(sequence, view);
    first = std::min(first, clock.first_frame());
    last = std::max(last, clock.last_frame());
  }
  std::vector<PointObservation> observations(sequence.cameras.size());
  for (int time = first; time <= last; ++time) {
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      for (std::size_t c = 0; c < observations.size(); ++c) {
        observations[c] = Observe(sequence, sequence.cameras[c], clocks[c].OwnFrame(time), joint, joint_count);
      }
      const TriangulatedPoint point = Triangulate(observations);
      if (!point.valid() || !point.in_front_of_all_cameras || point.largest_ray_angle_rad < kMinRayAngleRad) continue;
      for (std::size_t c = 0; c < observations.size(); ++c) {
        const PointObservation& seen = observations[c];
        if (seen.camera == nullptr) continue;
        const double error_px = (seen.camera->Project(point.point_in_world_mm) - seen.pixel).norm();
        if (errors_px != nullptr && seen.confidence > 0.0 && std::isfinite(error_px)) errors_px->push_back(error_px);
        const Eigen::Vector3d in_camera = seen.camera->InCamera(point.point_in_world_mm);
        const std::size_t i = static_cast<std::size_t>(clocks[c].OwnFrame(time)) * joint_count + joint;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          positions[c][3 * i + axis] = static_cast<float>(in_camera[static_cast<Eigen::Index>(axis)]);
        }
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
