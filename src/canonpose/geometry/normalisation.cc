#include "canonpose/geometry/normalisation.h"

#include <cmath>
#include <cstddef>

namespace canonpose {

bool NormalisePose(const float* keypoints, const float* confidence, int joint_count, int root, NormalisedPose& pose) {
  const auto joints = static_cast<std::size_t>(joint_count);
  const auto seen = [&](std::size_t j) {
    return confidence[j] > 0.0F && std::isfinite(keypoints[2 * j]) && std::isfinite(keypoints[2 * j + 1]);
  };
  const auto root_joint = static_cast<std::size_t>(root);
  if (!seen(root_joint)) return false;

  pose.keypoints.assign(2 * joints, 0.0F);
  pose.confidence.assign(joints, 0.0F);
  std::size_t seen_count = 0;
  double squares = 0.0;
  for (std::size_t j = 0; j < joints; ++j) {
    if (!seen(j)) continue;
    ++seen_count;
    const float x = keypoints[2 * j] - keypoints[2 * root_joint];
    const float y = keypoints[2 * j + 1] - keypoints[2 * root_joint + 1];
    pose.keypoints[j] = x;
    pose.keypoints[joints + j] = y;
    pose.confidence[j] = confidence[j];
    squares += static_cast<double>(x) * x + static_cast<double>(y) * y;
  }
  if (2 * seen_count < joints || !(squares > 0.0)) return false;
  pose.scale_px =
      static_cast<float>(std::sqrt(squares * static_cast<double>(joints) / static_cast<double>(seen_count)));
  for (float& value : pose.keypoints) value /= pose.scale_px;
  return true;
}

}  // namespace canonpose
