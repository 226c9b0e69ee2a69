// From a stage's channels to the rotations of a body's joints: legs by two-link inverse kinematics where feet are
// planted, limits of the joints, and limbs kept out of the trunk.
#pragma once

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/simulate/people/stage.h"

namespace canonpose {

/// Angles of an arm that brings the wrist to a place; see SideChannel.
struct ArmAngles {
  double flex;
  double abd;
  double twist;
  double elbow;
};

/// `wrist` is relative to the shoulder in the thorax' frame, in arm lengths, `elbow_towards` the direction in which the
/// elbow points; both for the left arm (y outwards), the same angles are the right arm's mirror image.
ArmAngles ReachWith(const Body& body, const Eigen::Vector3d& wrist, const Eigen::Vector3d& elbow_towards);

/// The motion of the body over the stage's frames. The pelvis is lowered where planted feet would be out of reach.
ArticulatedMotion PerformStage(const Stage& stage);

}  // namespace canonpose
