// Moves that activities consist of: a step, a walk to a place, a lifted leg, a jump. Each writes to a stage, starting
// at a given time, and most return the time of their end.
#pragma once

#include "canonpose/simulate/people/stage.h"

namespace canonpose {

/// The position of the pelvis after the strokes so far.
struct Spot {
  double x;
  double y;
  double yaw;
};
Spot FinalSpot(const Stage& stage);

/// Walks from the current position of pelvis and feet to a spot, with small steps.
double WalkTo(Stage& stage, double start, const Spot& spot);
/// A random spot within `radius_mm` of the origin and not far from the person, with a random heading.
Spot NearbySpot(Stage& stage, double radius_mm, double step_mm);

/// One foot steps by `ahead` and `left` (mm, relative to the pelvis' heading) and turns by `turn`.
void StepBy(Stage& stage, int side, double start, double duration, double ahead, double left, double turn);
/// The pelvis moves by `ahead` and `left`, mm.
void MovePelvis(Stage& stage, double start, double duration, double ahead, double left);
/// Moves the pelvis over one foot (`share` 1) or between the feet (0).
void ShiftWeight(Stage& stage, int side, double start, double duration, double share);

struct LegPose {
  double flex;  ///< of the line from hip to ankle
  double abd;
  double knee;
  double ankle = RadFromDeg(20.0);
  double twist = 0.0;
};
/// Lifts a foot off the ground into a pose; the pelvis moves over the other foot.
void LiftLeg(Stage& stage, int side, double start, double duration, const LegPose& pose);
/// Moves a leg that is already free.
void MoveLeg(Stage& stage, int side, double start, double duration, const LegPose& pose);
/// Puts the foot back where it was planted.
void LowerLeg(Stage& stage, int side, double start, double duration);

struct Jump {
  double height;       ///< that the pelvis reaches, mm
  double crouch;       ///< how far the pelvis goes down before, mm
  double ahead = 0.0;  ///< how far, mm
  double left = 0.0;
  double turn = 0.0;
  LegPose left_leg{RadFromDeg(2.0), RadFromDeg(4.0), RadFromDeg(14.0), RadFromDeg(42.0)};   ///< in flight
  LegPose right_leg{RadFromDeg(2.0), RadFromDeg(4.0), RadFromDeg(14.0), RadFromDeg(42.0)};  ///< in flight
  double feet_apart = 0.0;  ///< by how much the stance is wider after it, mm
  bool arms_swing = true;
  bool bounce = false;  ///< short and springy: a series of hops
};
/// Crouches, jumps and lands on both feet; returns the time at which the body stands again.
double DoJump(Stage& stage, double start, const Jump& jump);

}  // namespace canonpose
