// Moves that activities are made of: a step, a walk to a place, a lifted leg, a jump. Each writes to a stage from a
// time on and most say when they end.
#pragma once

#include "canonpose/simulate/people/stage.h"

namespace canonpose {

/// Where a stage's strokes so far leave the pelvis.
struct Spot {
  double x;
  double y;
  double yaw;
};
Spot FinalSpot(const Stage& stage);

/// Walks from where the pelvis and feet are to a spot, with small steps.
double WalkTo(Stage& stage, double start, const Spot& spot);
/// A random spot within `radius_mm` of the origin, not far from where the person is, looking anywhere.
Spot NearbySpot(Stage& stage, double radius_mm, double step_mm);

/// One foot steps by `ahead` and `left` (mm, in the pelvis' direction) and turns by `turn`.
void StepBy(Stage& stage, int side, double start, double duration, double ahead, double left, double turn);
/// The pelvis moves by `ahead` and `left`, mm.
void MovePelvis(Stage& stage, double start, double duration, double ahead, double left);
/// The pelvis over one foot (`share` 1), between the feet (0).
void ShiftWeight(Stage& stage, int side, double start, double duration, double share);

struct LegPose {
  double flex;  ///< of the line from hip to ankle
  double abd;
  double knee;
  double ankle = RadFromDeg(20.0);
  double twist = 0.0;
};
/// Lifts a foot off the ground into a pose; the pelvis goes over the other.
void LiftLeg(Stage& stage, int side, double start, double duration, const LegPose& pose);
/// Moves an already free leg.
void MoveLeg(Stage& stage, int side, double start, double duration, const LegPose& pose);
/// Puts the foot back where it was planted.
void LowerLeg(Stage& stage, int side, double start, double duration);

struct Jump {
  double height;       ///< of the pelvis' flight, mm
  double crouch;       ///< how deep the pelvis goes before, mm
  double ahead = 0.0;  ///< how far, mm
  double left = 0.0;
  double turn = 0.0;
  LegPose left_leg{RadFromDeg(2.0), RadFromDeg(4.0), RadFromDeg(14.0), RadFromDeg(42.0)};   ///< in flight
  LegPose right_leg{RadFromDeg(2.0), RadFromDeg(4.0), RadFromDeg(14.0), RadFromDeg(42.0)};  ///< in flight
  double feet_apart = 0.0;  ///< by how much the stance is wider after it, mm
  bool arms_swing = true;
  bool bounce = false;  ///< short and springy: hops in a row
};
/// Crouches, flies and lands on both feet; returns when the body stands again.
double DoJump(Stage& stage, double start, const Jump& jump);

}  // namespace canonpose
