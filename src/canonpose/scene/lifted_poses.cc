#include "canonpose/scene/lifted_poses.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace canonpose {

LiftedPoses::LiftedPoses(const Skeleton& skeleton, int frame_count, const std::string& camera)
    : pose_in_camera(skeleton, frame_count), canonical(skeleton, frame_count) {
  pose_in_camera.unit = canonical.unit = LengthUnit::kEachItsOwn;
  pose_in_camera.coordinate_frame = {CoordinateFrame::Kind::kRoot, camera};
  canonical.coordinate_frame.kind = CoordinateFrame::Kind::kBody;
  const auto count = static_cast<std::size_t>(frame_count);
  rotation.assign(9 * count, std::numeric_limits<float>::quiet_NaN());
  frames.resize(count);
  std::iota(frames.begin(), frames.end(), 0);
}

void LiftedPoses::HideUnseenJoints() {
  for (PoseSequence* poses : {&pose_in_camera, &canonical}) {
    for (std::size_t i = 0; i < poses->confidence().size(); ++i) {
      if (poses->confidence()[i] > 0.0F) continue;
      std::fill_n(poses->positions().begin() + 3 * static_cast<std::ptrdiff_t>(i), 3,
                  std::numeric_limits<float>::quiet_NaN());
    }
  }
}

}  // namespace canonpose
