#include "canonpose/model/pose_input.h"

#include <cstddef>

namespace canonpose {

PoseInput::PoseInput(const InputForm& form, const Skeleton& skeleton)
    : turns_(form.ray == RayForm::kRoot),
      uses_known_(form.focal == FocalSource::kKnown),
      joint_count_(skeleton.joint_count()),
      root_(skeleton.root) {}

Pinhole PoseInput::PinholeOf(const CameraView& view, int t) const {
  if (uses_known_ && !view.solved_calibration.empty()) return Pinhole::FromK(view.SolvedCalibrationAt(t).K);
  if (uses_known_ && !view.calibration.empty()) return Pinhole::FromK(view.CalibrationAt(t).K);
  return Pinhole::Guess(view.image_size);
}

bool PoseInput::LacksCamera(const CameraView& view) const { return turns_ && !PinholeOf(view, 0).is_known(); }

bool PoseInput::Normalise(const CameraView& view, int t, NormalisedPose& pose,
                          Eigen::Matrix3d& turned_from_camera) const {
  const std::size_t offset = static_cast<std::size_t>(t) * static_cast<std::size_t>(joint_count_);
  return NormalisePoseOnAxis(&view.keypoints[2 * offset], &view.confidence[offset], joint_count_, root_,
                             turns_ ? PinholeOf(view, t) : Pinhole{}, pose, turned_from_camera);
}

}  // namespace canonpose
