// Inverse kinematics of a whole body: small rotations of all joints that bring the joints of a hierarchy to where they
// were seen.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Where joints were seen: (T, J). A weight of 0 stands for a joint that was not; its position is ignored.
struct SeenJoints {
  std::vector<Eigen::Vector3d> positions_mm;
  std::vector<double> weights;
};

/// Changes, in every frame by itself, the rotations of joints and the root's position so that the weighted squares of
/// the distances to the seen joints become least. Rotations resist, towards those that come in, so that what no joint
/// shows, such as the twist of a straight limb, stays as it is: turning joint j by 1 rad costs as much as moving a seen
/// joint of weight 1 by resistance_mm[j]. A joint with resistance 0 does not turn. Frames without any seen joint stay
/// as they are.
void RefinePositions(ArticulatedMotion& motion, const std::vector<double>& resistance_mm, const SeenJoints& seen);

}  // namespace canonpose
