// What the network sees of a 2D pose: root-centred, of unit size, planar.
#pragma once

#include <vector>

namespace canonpose {

/// A 2D pose as the lifter takes it. Missing joints are 0 with confidence 0.
struct NormalisedPose {
  std::vector<float> keypoints;   ///< (2J) planar: x of all joints, then y of all joints
  std::vector<float> confidence;  ///< (J)
  float scale_px = 0.0F;          ///< what the centred pose was divided by
};

/// Subtracts the root joint and divides by the Frobenius norm of the joints that are seen, so that a full pose has
/// norm 1. With S of J joints seen the norm is sqrt(S / J): each joint keeps the size it would have in a full pose.
///
/// keypoints is (J, 2) in pixels, NaN where missing; confidence is (J), 0 where missing. Returns false, `pose`
/// unspecified, where the root or more than half of the joints are missing, or all joints coincide.
bool NormalisePose(const float* keypoints, const float* confidence, int joint_count, int root, NormalisedPose& pose);

}  // namespace canonpose
