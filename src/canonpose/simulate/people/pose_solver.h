// Converts a stage's channels to the rotations of a body's joints: two-link inverse kinematics for legs with planted
// feet, joint limits, and keeping limbs out of the trunk.
#pragma once

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/simulate/people/stage.h"

namespace canonpose {

/// Angles of an arm whose wrist is at a given place; see SideChannel.
struct ArmAngles {
  double flex;
  double abd;
  double twist;
  double elbow;
};

/// `wrist` is relative to the shoulder, in the frame of the thorax and in arm lengths; `elbow_towards` is the direction
/// in which the elbow points. Both are for the left arm (y outwards); the same angles give the mirror image for the
/// right arm.
ArmAngles ReachWith(const Body& body, const Eigen::Vector3d& wrist, const Eigen::Vector3d& elbow_towards);

/// The motion of the body over the stage's frames. The pelvis is lowered where planted feet would be out of reach.
ArticulatedMotion PerformStage(const Stage& stage);

}  // namespace canonpose
