// What a lifter makes of the 2D poses of one camera.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// 3D poses of T frames, relative to the root: pose_in_camera = rotation * canonical. NaN in frames that could not be
/// lifted. A joint has the confidence that the 2D joint has; one that the view does not show has confidence 0, and its
/// position is the network's guess, until HideUnseenJoints() makes it NaN. Each pose has a scale of its own, the
/// network's, until all are scaled to millimetres.
struct LiftedPoses {
  LiftedPoses() = default;
  /// All poses missing, of the frames 0 to frame_count - 1.
  LiftedPoses(const Skeleton& skeleton, int frame_count, const std::string& camera);

  [[nodiscard]] int frame_count() const { return pose_in_camera.frame_count(); }
  [[nodiscard]] int joint_count() const { return pose_in_camera.joint_count(); }
  [[nodiscard]] const Skeleton& skeleton() const { return pose_in_camera.skeleton(); }
  /// Makes the joints NaN that the view does not show.
  void HideUnseenJoints();

  PoseSequence pose_in_camera;       ///< about the root, with the axes of the camera
  PoseSequence canonical;            ///< about the root, with axes that move with the body
  std::vector<float> rotation;       ///< (T, 3, 3) camera_from_canonical
  std::vector<std::int64_t> frames;  ///< (T) ascending numbers of the frames in the input
};

}  // namespace canonpose
