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

/// Clocks that differ by less than this, in frames, are in step.
constexpr double kInStep = 1e-6;
/// Between two frames, a keypoint is at most this share of the way from the nearer one.
constexpr double kLargestShare = 0.7;
/// Where there is no other frame to interpolate with, one is used if it is this near, in frames.
constexpr double kNearEnough = 0.25;

/// What a view shows in a frame of the sequence, a keypoint between two of its own frames if its clock differs from the
/// others' by a fraction; nothing where there is none.
class ViewAtTime {
 public:
  ViewAtTime(const Sequence& sequence, const CameraView& view, const ViewClock& clock, int time)
      : view_(view), own_(clock.OwnFrame(time)) {
    if (view.calibration.empty() || own_ < 0) return;
    is_left_out_ = IsLeftOut(sequence, view, own_);
    const double late = time - clock.TimeOf(own_);
    if (std::abs(late) < kInStep) return;
    const int other = own_ + (late > 0.0 ? 1 : -1);
    if (other >= 0 && other < sequence.frame_count && !IsLeftOut(sequence, view, other)) {
      const double share = std::abs(late / (clock.TimeOf(other) - clock.TimeOf(own_)));
      // Of a camera that has another rate, the nearest frame is taken.
      if (share <= kLargestShare) {
        other_ = other;
        share_ = share;
        return;
      }
    }
    if (std::abs(late) > kNearEnough) own_ = -1;
  }

  [[nodiscard]] PointObservation Observe(std::size_t joint, std::size_t joint_count) const {
    PointObservation observation;
    if (view_.calibration.empty() || own_ < 0) return observation;
    observation.camera = &view_.CalibrationAt(own_);
    if (is_left_out_) return observation;
    const std::size_t i = static_cast<std::size_t>(own_) * joint_count + joint;
    observation.pixel = {view_.keypoints[2 * i], view_.keypoints[2 * i + 1]};
    observation.confidence = view_.confidence[i];
    if (other_ < 0) return observation;
    const std::size_t k = static_cast<std::size_t>(other_) * joint_count + joint;
    const Eigen::Vector2d pixel(view_.keypoints[2 * k], view_.keypoints[2 * k + 1]);
    observation.pixel = (1.0 - share_) * observation.pixel + share_ * pixel;  // NaN where one does not see it
    const bool is_seen = observation.confidence > 0.0 && view_.confidence[k] > 0.0F;
    observation.confidence = is_seen ? (1.0 - share_) * observation.confidence + share_ * view_.confidence[k] : 0.0;
    return observation;
  }

 private:
  const CameraView& view_;
  int own_;
  int other_ = -1;
  double share_ = 0.0;
  bool is_left_out_ = false;
};

/// Joints in the world, frame by frame of the sequence and beyond; NaN where they are unknown.
class WorldJoints {
 public:
  WorldJoints(int first, int last, std::size_t joint_count)
      : first_(first),
        joint_count_(joint_count),
        points_(static_cast<std::size_t>(last - first + 1) * joint_count, Eigen::Vector3d::Constant(kUnknown)) {}
  [[nodiscard]] Eigen::Vector3d& At(int time, std::size_t joint) {
    return points_[static_cast<std::size_t>(time - first_) * joint_count_ + joint];
  }
  /// Between frames by linear interpolation.
  [[nodiscard]] Eigen::Vector3d Between(double time, std::size_t joint) const {
    const double before = std::floor(time);
    if (!(before >= first_)) return Eigen::Vector3d::Constant(kUnknown);
    const auto i = static_cast<std::size_t>(before - first_) * joint_count_ + joint;
    if (i + joint_count_ >= points_.size()) return Eigen::Vector3d::Constant(kUnknown);
    const double share = time - before;
    return (1.0 - share) * points_[i] + share * points_[i + joint_count_];
  }

 private:
  int first_;
  std::size_t joint_count_;
  std::vector<Eigen::Vector3d> points_;
};

/// The joints in the frame of a calibrated camera, in its own time.
std::vector<float> JointsInCamera(const CameraView& view, const ViewClock& clock, int frame_count,
                                  std::size_t joint_count, WorldJoints& joints) {
  std::vector<float> positions(3 * static_cast<std::size_t>(frame_count) * joint_count, kUnknown);
  for (int own = 0; own < frame_count; ++own) {
    const double time = clock.TimeOf(own);
    if (!std::isfinite(time)) continue;
    const double nearest = std::round(time);
    const bool is_in_step = std::abs(time - nearest) < kInStep;
    if (is_in_step && clock.OwnFrame(static_cast<int>(nearest)) != own) continue;
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      const Eigen::Vector3d point =
          is_in_step ? joints.At(static_cast<int>(nearest), joint) : joints.Between(time, joint);
      if (!point.allFinite()) continue;
      const Eigen::Vector3d in_camera = view.CalibrationAt(own).InCamera(point);
      const std::size_t i = static_cast<std::size_t>(own) * joint_count + joint;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        positions[3 * i + axis] = static_cast<float>(in_camera[static_cast<Eigen::Index>(axis)]);
      }
    }
  }
  return positions;
}

}  // namespace

SequencePoses TriangulateSequence(const Sequence& sequence, const Skeleton& skeleton, std::vector<double>* errors_px) {
  const std::size_t joint_count = skeleton.joints.size();
  int first = 0;
  int last = sequence.frame_count - 1;
  std::vector<ViewClock> clocks;
  for (const CameraView& view : sequence.cameras) {
    const ViewClock& clock = clocks.emplace_back(sequence, view);
    first = std::min(first, clock.first_frame());
    last = std::max(last, clock.last_frame());
  }
  WorldJoints joints(first, last, joint_count);
  std::vector<PointObservation> observations(sequence.cameras.size());
  for (int time = first; time <= last; ++time) {
    std::vector<ViewAtTime> views;
    for (std::size_t c = 0; c < clocks.size(); ++c) views.emplace_back(sequence, sequence.cameras[c], clocks[c], time);
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      for (std::size_t c = 0; c < observations.size(); ++c) {
        observations[c] = views[c].Observe(joint, joint_count);
      }
      const TriangulatedPoint point = Triangulate(observations);
      if (!point.valid() || !point.in_front_of_all_cameras || point.largest_ray_angle_rad < kMinRayAngleRad) continue;
      joints.At(time, joint) = point.point_in_world_mm;
      for (const PointObservation& seen : observations) {
        if (seen.camera == nullptr || errors_px == nullptr) continue;
        const double error_px = (seen.camera->Project(point.point_in_world_mm) - seen.pixel).norm();
        if (seen.confidence > 0.0 && std::isfinite(error_px)) errors_px->push_back(error_px);
      }
    }
  }
  SequencePoses poses;
  for (std::size_t c = 0; c < clocks.size(); ++c) {
    const CameraView& view = sequence.cameras[c];
    std::vector<float> positions;
    if (!view.calibration.empty())
      positions = JointsInCamera(view, clocks[c], sequence.frame_count, joint_count, joints);
    poses.poses_in_camera.push_back(PosesInCamera(skeleton, std::move(positions), LengthUnit::kMillimetres, view.name));
  }
  return poses;
}

}  // namespace canonpose
