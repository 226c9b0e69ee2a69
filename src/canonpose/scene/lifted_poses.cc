#include "canonpose/scene/lifted_poses.h"

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

}  // namespace canonpose
