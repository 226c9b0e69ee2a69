// Common postures of the arm: where the hand is and where the elbow points.
#pragma once

#include "canonpose/simulate/people/pose_solver.h"
#include "canonpose/simulate/people/stage.h"

namespace canonpose {

enum class ArmPose {
  kHang,
  kHip,         ///< hand on the hip
  kPhone,       ///< hand at the ear
  kBehindHead,  ///< hand behind the head
  kHeadTop,     ///< hand on the head
  kOverhead,
  kSideways,
  kForward,
  kUpDiagonal,
  kGoalpost,  ///< upper arm sideways, forearm up
  kChest,     ///< hand in front of the chest
  kCross,     ///< hand at the other elbow
  kBelly,     ///< hands in front of the belly
  kBehindBack,
  kGuard,  ///< boxer's
  kPocket,
  kPointAhead,
  kOtherShoulder,
  kChin,
  kLowForward,
  kCarry,  ///< forearm forward, elbow at the side
  kCount
};

/// The angles of a pose for a body, with a little random variation.
ArmAngles AnglesOf(Stage& stage, ArmPose pose);
/// Random angles in the whole range of the joints; hands behind the trunk are rare.
ArmAngles RandomArm(Stage& stage);
/// Moves an arm.
void MoveArm(Stage& stage, int side, double start, double duration, const ArmAngles& angles);
/// Moves an arm back to its position in StandNaturally().
ArmAngles HangingArm(Stage& stage);

}  // namespace canonpose
