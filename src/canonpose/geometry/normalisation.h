// The form in which the network gets a 2D pose: root-centred, of unit size, planar.
#pragma once

#include <vector>

namespace canonpose {

/// A 2D pose as input of the lifter. Missing joints are 0 with confidence 0.
struct NormalisedPose {
  std::vector<float> keypoints;   ///< (2J) planar: x of all joints, then y of all joints
  std::vector<float> confidence;  ///< (J)
  float scale_px = 0.0F;          ///< what the centred pose was divided by
};

/// Subtracts the root joint and scales to unit Frobenius norm. Where only S of J joints are seen, they get the norm
/// sqrt(S / J), so that each joint has about the size that it would have in a full pose.
///
/// keypoints is (J, 2) in pixels, NaN where missing; confidence is (J), 0 where missing. Returns false, with `pose`
/// unspecified, where the root or more than half of the joints are missing, or all joints coincide.
bool NormalisePose(const float* keypoints, const float* confidence, int joint_count, int root, NormalisedPose& pose);

}  // namespace canonpose
