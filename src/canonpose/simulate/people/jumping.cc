// Jumps, squats, lunges and kneeling.
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/moves.h"

namespace canonpose {
namespace {

double JumpUp(Stage& stage, double t, bool squat_jump) {
  Jump jump{};
  jump.height = stage.Tall(stage.Uniform(0.10, 0.24));
  jump.crouch = stage.Tall(squat_jump ? stage.Uniform(0.20, 0.30) : stage.Uniform(0.10, 0.22));
  jump.arms_swing = !squat_jump || stage.Chance(0.3);
  if (stage.Chance(0.3)) jump.turn = RadFromDeg(stage.Uniform(-180.0, 180.0));
  if (stage.Chance(0.35)) {
    // Tucked.
    const double flex = RadFromDeg(stage.Uniform(25.0, 70.0));
    const double knee = RadFromDeg(stage.Uniform(70.0, 120.0));
    jump.left_leg = {flex, RadFromDeg(5.0), knee, RadFromDeg(30.0)};
    jump.right_leg = {flex + RadFromDeg(stage.Uniform(-8.0, 8.0)), RadFromDeg(5.0), knee, RadFromDeg(30.0)};
    jump.height = stage.Tall(stage.Uniform(0.17, 0.26));
  } else if (stage.Chance(0.3)) {
    // Heels back.
    const double knee = RadFromDeg(stage.Uniform(60.0, 105.0));
    jump.left_leg = {RadFromDeg(-28.0), RadFromDeg(4.0), knee, RadFromDeg(45.0)};
    jump.right_leg = {RadFromDeg(-28.0), RadFromDeg(4.0), knee + RadFromDeg(stage.Uniform(-20.0, 20.0)),
                      RadFromDeg(45.0)};
  }
  return DoJump(stage, t, jump);
}

double LongJump(Stage& stage, double t) {
  Jump jump{};
  const Spot spot = FinalSpot(stage);
  // Stays in the room by moving to the side of the origin.
  const double towards = -(spot.x * std::cos(spot.yaw) + spot.y * std::sin(spot.yaw));
  const double sign = towards >= 0.0 || std::hypot(spot.x, spot.y) < 300.0 ? 1.0 : -1.0;
  jump.height = stage.Tall(stage.Uniform(0.10, 0.18));
  jump.crouch = stage.Tall(stage.Uniform(0.16, 0.26));
  jump.ahead = stage.Tall(stage.Uniform(0.25, 0.75)) * (sign > 0.0 ? 1.0 : -0.4);
  const double flex = RadFromDeg(sign > 0.0 ? stage.Uniform(15.0, 50.0) : 0.0);
  jump.left_leg = {flex, RadFromDeg(4.0), RadFromDeg(60.0), RadFromDeg(15.0)};
  jump.right_leg = jump.left_leg;
  return DoJump(stage, t, jump);
}

double SideJump(Stage& stage, double t) {
  Jump jump{};
  jump.height = stage.Tall(stage.Uniform(0.06, 0.13));
  jump.crouch = stage.Tall(stage.Uniform(0.08, 0.16));
  jump.left = stage.Tall(stage.Uniform(0.15, 0.4)) * SideSign(stage.RandomSide());
  return DoJump(stage, t, jump);
}

// Arms and legs spread in the air, or jumping jacks that land spread.
double StarJump(Stage& stage, double t) {
  const bool jacks = stage.Chance(0.6);
  const int count = jacks ? 2 * (1 + static_cast<int>(stage.rng().Index(3))) : 1;
  const double spread = RadFromDeg(stage.Uniform(22.0, 38.0));
  const double up = RadFromDeg(stage.Uniform(100.0, 165.0));
  for (int i = 0; i < count; ++i) {
    Jump jump{};
    const bool opening = i % 2 == 0;
    jump.bounce = jacks;
    jump.height = stage.Tall(jacks ? stage.Uniform(0.045, 0.08) : stage.Uniform(0.15, 0.24));
    jump.crouch = stage.Tall(jacks ? 0.07 : 0.18);
    jump.arms_swing = false;
    const double abd = jacks ? 0.5 * spread : spread;
    jump.left_leg = jump.right_leg = {RadFromDeg(2.0), abd, RadFromDeg(10.0), RadFromDeg(35.0)};
    if (jacks && opening) jump.feet_apart = stage.Tall(0.24);
    const double end = DoJump(stage, t, jump);
    for (const int side : {kLeft, kRight}) {
      const int abduction = Of(kShoulderAbd, side);
      if (jacks) {
        stage.MoveTo(abduction, t + 0.12, 0.40, opening ? up : stage.style().arm_carry);
        stage.MoveTo(Of(kShoulderTwist, side), t + 0.12, 0.40, opening ? RadFromDeg(-40.0) : RadFromDeg(10.0));
      } else {
        stage.Bump(abduction, t + 0.25, end - t - 0.3, up);
      }
    }
    t = end;
  }
  return t;
}

double HopSeveral(Stage& stage, double t) {
  const bool one_leg = stage.Chance(0.5);
  const int hopping = stage.RandomSide();
  const int count = 2 + static_cast<int>(stage.rng().Index(4));
  if (one_leg) {
    LiftLeg(stage, 1 - hopping, t + 0.2, 0.5,
            {RadFromDeg(stage.Uniform(0.0, 60.0)), RadFromDeg(stage.Uniform(2.0, 15.0)),
             RadFromDeg(stage.Uniform(55.0, 110.0))});
    t += 0.8;
  }
  // Hopping on one leg, the other is held up all the time: the pelvis bounces and the hopping foot follows.
  for (int i = 0; i < count; ++i) {
    if (!one_leg) {
      Jump jump{};
      jump.bounce = true;
      jump.height = stage.Tall(stage.Uniform(0.03, 0.07));
      jump.crouch = stage.Tall(0.06);
      jump.ahead = stage.Tall(stage.Uniform(-0.06, 0.1));
      jump.arms_swing = false;
      t = DoJump(stage, t, jump);
      continue;
    }
    const double period = stage.Uniform(0.42, 0.55);
    stage.Bump(kPelvisZ, t, 0.45 * period, -stage.Tall(0.05));
    stage.Bump(kPelvisZ, t + 0.25 * period, 0.75 * period, stage.Tall(stage.Uniform(0.05, 0.07)));
    stage.Bump(Of(kFootLift, hopping), t + 0.33 * period, 0.6 * period, stage.Tall(0.07));
    stage.Bump(Of(kFootPitch, hopping), t + 0.2 * period, 0.8 * period, RadFromDeg(35.0));
    t += period;
  }
  if (one_leg) {
    LowerLeg(stage, 1 - hopping, t + 0.1, 0.5);
    t += 0.9;
  }
  return t;
}

// What the arms do while the legs work.
void ArmsForSquat(Stage& stage, double down, double up, double duration) {
  const double choice = stage.Uniform(0.0, 1.0);
  if (choice < 0.25) return;
  const ArmPose poses[] = {ArmPose::kForward, ArmPose::kHip,      ArmPose::kBelly,   ArmPose::kBehindHead,
                           ArmPose::kCross,   ArmPose::kOverhead, ArmPose::kCarry,   ArmPose::kSideways,
                           ArmPose::kChest,   ArmPose::kGoalpost, ArmPose::kForward, ArmPose::kUpDiagonal};
  const ArmPose pose = poses[stage.rng().Index(12)];
  const int one = stage.RandomSide();
  const bool mixed = choice > 0.85;
  for (const int side : {kLeft, kRight}) {
    const ArmAngles angles = mixed && side == one ? RandomArm(stage) : AnglesOf(stage, pose);
    MoveArm(stage, side, down, duration * stage.Uniform(0.8, 1.1), angles);
    MoveArm(stage, side, up, duration * stage.Uniform(0.8, 1.1), HangingArm(stage));
  }
}

void BendTrunk(Stage& stage, double start, double duration, double pitch, double flex) {
  stage.MoveTo(kPelvisPitch, start, duration, pitch);
  stage.MoveTo(kTrunkFlex, start, duration, stage.style().trunk_lean + flex);
  stage.MoveTo(kNeckFlex, start, duration, stage.style().head_pitch - 0.5 * (pitch + flex));
}

double DoSquat(Stage& stage, double t) {
  const double depth = stage.Tall(stage.Uniform(0.19, 0.35));
  const double down = stage.Beat(0.9);
  const double hold = stage.Chance(0.3) ? stage.Uniform(0.4, 2.0) : 0.05;
  const double up = stage.Beat(0.9);
  const double widen = stage.Chance(0.5) ? stage.Tall(stage.Uniform(0.02, 0.09)) : 0.0;
  if (widen > 0.0) {
    for (const int side : {kLeft, kRight}) {
      StepBy(stage, side, t, 0.4, 0.0, SideSign(side) * widen, SideSign(side) * RadFromDeg(stage.Uniform(5.0, 20.0)));
      t += 0.45;
    }
  }
  stage.MoveBy(kPelvisZ, t, down, -depth);
  stage.MoveTo(kSurge, t, down, -0.35 * depth);
  BendTrunk(stage, t, down, RadFromDeg(stage.Uniform(12.0, 40.0)), RadFromDeg(stage.Uniform(-8.0, 22.0)));
  ArmsForSquat(stage, t, t + down + hold, down);
  for (const int side : {kLeft, kRight}) {
    stage.MoveTo(Of(kLegTwist, side), t, down, RadFromDeg(stage.Uniform(0.0, 18.0)));
    stage.MoveTo(Of(kLegTwist, side), t + down + hold, up, 0.0);
  }
  t += down + hold;
  stage.MoveBy(kPelvisZ, t, up, depth);
  stage.MoveTo(kSurge, t, up, 0.0);
  BendTrunk(stage, t, up, 0.0, 0.0);
  t += up;
  if (widen > 0.0) t = WalkTo(stage, t, FinalSpot(stage));
  return t;
}

// A long step forward, sideways or back and down, and back again.
double DoLunge(Stage& stage, double t) {
  const int side = stage.RandomSide();
  const double choice = stage.Uniform(0.0, 1.0);
  const double length = stage.Tall(stage.Uniform(0.34, 0.50));
  const double ahead = choice < 0.55 ? length : (choice < 0.75 ? -length : 0.15 * length);
  const double left = choice < 0.75 ? 0.0 : SideSign(side) * length * 0.85;
  const double step = stage.Beat(0.65);
  const double sink = stage.Tall(stage.Uniform(0.13, 0.24));
  const double hold = stage.Uniform(0.05, 0.9);
  StepBy(stage, side, t, step, ahead, left, 0.0);
  MovePelvis(stage, t + 0.15, step + 0.2, 0.5 * ahead, 0.62 * left);
  stage.MoveBy(kPelvisZ, t + 0.35 * step, step, -sink);
  const double turn = stage.Uniform(-1.0, 1.0) * RadFromDeg(30.0);
  stage.MoveTo(kTrunkTwist, t + 0.3, step, turn);
  BendTrunk(stage, t + 0.2, step, RadFromDeg(stage.Uniform(-2.0, 14.0)) + (choice < 0.75 ? 0.0 : RadFromDeg(18.0)),
            RadFromDeg(stage.Uniform(-5.0, 20.0)));
  // The rear heel comes up.
  const int behind = ahead > 0.0 ? 1 - side : side;
  const double heel = choice < 0.75 ? RadFromDeg(stage.Uniform(35.0, 60.0)) : 0.0;
  stage.MoveTo(Of(kFootPitch, behind), t + 0.5 * step, 0.7 * step, heel);
  ArmsForSquat(stage, t + 0.1, t + 1.4 * step + hold, step);
  t += 1.4 * step + hold;
  const double back = stage.Beat(0.75);
  MovePelvis(stage, t, back, -0.5 * ahead, -0.62 * left);
  stage.MoveBy(kPelvisZ, t, 0.8 * back, sink);
  stage.MoveTo(Of(kFootPitch, behind), t, 0.5 * back, 0.0);
  StepBy(stage, side, t + 0.25 * back, 0.75 * back, -ahead, -left, 0.0);
  stage.MoveTo(kTrunkTwist, t, back, 0.0);
  BendTrunk(stage, t, back, 0.0, 0.0);
  return t + back + 0.1;
}

// Down on one knee, sometimes on both, and up again.
double DoKneel(Stage& stage, double t) {
  const int down_side = stage.RandomSide();
  const auto i = Body::Index(down_side);
  const Body& body = stage.body();
  const double step = stage.Beat(0.7);
  const double back = 0.55 * (body.shank[i] + body.ball[i]);
  StepBy(stage, down_side, t, step, -1.25 * back, 0.0, 0.0);
  StepBy(stage, 1 - down_side, t + 0.85 * step, 0.8 * step, 0.75 * back, 0.0, 0.0);
  stage.MoveTo(Of(kFootPitch, down_side), t + 0.4, 1.2, RadFromDeg(68.0));
  t += 1.3 * step;
  const double kneeling = body.thigh[i] + stage.Tall(0.045) - body.standing_hip_height();
  const double home = stage.Final(kPelvisZ);
  stage.MoveTo(kPelvisZ, t, 1.0, kneeling);
  stage.MoveTo(kSurge, t, 1.0, -0.1 * back);
  BendTrunk(stage, t, 0.9, RadFromDeg(stage.Uniform(-4.0, 12.0)), RadFromDeg(stage.Uniform(-5.0, 30.0)));
  t += 1.05;
  const double stay = stage.Uniform(1.5, 4.0);
  const double end = t + stay;
  for (double g = t; g < end - 1.2;) g = MakeGesture(stage, g, stage.Uniform(1.0, 2.5));
  stage.MoveTo(kTrunkFlex, t + 0.3 * stay, 0.8, RadFromDeg(stage.Uniform(-5.0, 45.0)));
  stage.MoveTo(kTrunkTwist, t + 0.3 * stay, 0.8, RadFromDeg(stage.Uniform(-35.0, 35.0)));
  stage.MoveTo(kTrunkTwist, end - 0.8, 0.8, 0.0);
  t = end;
  for (const int side : {kLeft, kRight}) MoveArm(stage, side, t, 0.9, HangingArm(stage));
  stage.MoveTo(kPelvisZ, t, 0.9, home);
  stage.MoveTo(kSurge, t, 0.9, 0.0);
  BendTrunk(stage, t, 0.9, 0.0, 0.0);
  stage.MoveTo(Of(kFootPitch, down_side), t + 0.2, 0.8, 0.0);
  StepBy(stage, down_side, t + 0.6, 0.6, 1.25 * back, 0.0, 0.0);
  StepBy(stage, 1 - down_side, t + 1.1, 0.5, -0.75 * back, 0.0, 0.0);
  return t + 1.7;
}

// Knee under the hip and shank on the floor, relative to a pelvis pitched forward.
LegPose KneelingLeg(double pitch) {
  return {pitch - RadFromDeg(45.0), RadFromDeg(3.0), RadFromDeg(90.0), RadFromDeg(55.0)};
}

// On hands and knees: an arm or a leg is stretched out, the back bends and arches.
double MoveOnAllFours(Stage& stage, double t, double until, double pitch) {
  while (t < until) {
    const double beat = stage.Beat(1.0);
    const double hold = stage.Uniform(0.2, 1.0);
    const int side = stage.RandomSide();
    const bool arm = stage.Chance(0.6);
    const bool leg = stage.Chance(0.6);
    stage.MoveTo(kTrunkFlex, t, beat, RadFromDeg(stage.Uniform(-22.0, 30.0)));
    stage.MoveTo(kNeckFlex, t, beat, RadFromDeg(stage.Uniform(-50.0, 10.0)));
    if (arm) {
      const ArmAngles angles = stage.Chance(0.6) ? ArmAngles{RadFromDeg(stage.Uniform(120.0, 165.0)), RadFromDeg(10.0),
                                                             0.0, RadFromDeg(12.0)}
                                                 : RandomArm(stage);
      MoveArm(stage, side, t, beat, angles);
      stage.MoveTo(Of(kHandWeight, side), t, beat, 0.0);
      stage.MoveTo(Of(kHandWeight, side), t + beat + hold, beat, 1.0);
      MoveArm(stage, side, t + beat + hold, beat, AnglesOf(stage, ArmPose::kForward));
    }
    if (leg) {
      const LegPose back{pitch - RadFromDeg(stage.Uniform(70.0, 92.0)), RadFromDeg(4.0),
                         RadFromDeg(stage.Uniform(5.0, 60.0)), RadFromDeg(30.0)};
      MoveLeg(stage, 1 - side, t, beat, back);
      MoveLeg(stage, 1 - side, t + beat + hold, beat, KneelingLeg(pitch));
    }
    t += arm || leg ? 2.0 * beat + hold + 0.1 : beat;
  }
  return t;
}

double DoAllFours(Stage& stage, double t) {
  const double down = stage.Beat(1.6);
  const double pitch = RadFromDeg(stage.Uniform(66.0, 82.0));
  const double home = stage.Final(kPelvisZ);
  const double ahead = stage.Tall(0.12);
  const Spot spot = FinalSpot(stage);
  const double height = stage.body().thigh[kLeft] + stage.Tall(0.04) - stage.body().standing_hip_height();
  stage.MoveTo(kPelvisZ, t, down, height);
  stage.MoveTo(kSurge, t + 0.3 * down, 0.7 * down, ahead);
  BendTrunk(stage, t, down, pitch, RadFromDeg(5.0));
  for (const int side : {kLeft, kRight}) {
    const double reach = ahead + 0.95 * stage.body().trunk * std::sin(pitch);
    const double across = SideSign(side) * stage.Tall(stage.Uniform(0.09, 0.13));
    stage.MoveTo(Of(kHandX, side), t - 0.03, 0.02, spot.x + std::cos(spot.yaw) * reach - std::sin(spot.yaw) * across);
    stage.MoveTo(Of(kHandY, side), t - 0.03, 0.02, spot.y + std::sin(spot.yaw) * reach + std::cos(spot.yaw) * across);
    stage.MoveTo(Of(kHandZ, side), t - 0.03, 0.02, stage.Tall(0.035));
    MoveArm(stage, side, t, 0.8 * down, AnglesOf(stage, ArmPose::kForward));
    stage.MoveTo(Of(kHandWeight, side), t, down, 1.0);
    MoveLeg(stage, side, t - 0.03, 0.03, {RadFromDeg(10.0), RadFromDeg(3.0), RadFromDeg(60.0), RadFromDeg(5.0)});
    stage.MoveTo(Of(kFree, side), t + 0.35 * down, 0.6 * down, 1.0);
    MoveLeg(stage, side, t, down, KneelingLeg(pitch));
  }
  t = MoveOnAllFours(stage, t + down + 0.2, t + down + stage.Uniform(2.0, 6.0), pitch);
  const double up = stage.Beat(1.8);
  for (const int side : {kLeft, kRight}) {
    MoveLeg(stage, side, t, 0.8 * up, {RadFromDeg(30.0), RadFromDeg(3.0), RadFromDeg(80.0), RadFromDeg(5.0)});
    stage.MoveTo(Of(kFree, side), t + 0.1 * up, 0.6 * up, 0.0);
    stage.MoveTo(Of(kLegTwist, side), t, up, 0.0);
    stage.MoveTo(Of(kHandWeight, side), t + 0.25 * up, 0.6 * up, 0.0);
    MoveArm(stage, side, t + 0.3 * up, 0.8 * up, HangingArm(stage));
  }
  stage.MoveTo(kSurge, t, 0.7 * up, 0.0);
  stage.MoveTo(kPelvisZ, t + 0.35 * up, 0.75 * up, home);
  BendTrunk(stage, t + 0.3 * up, 0.8 * up, 0.0, 0.0);
  return t + 1.15 * up;
}

}  // namespace

void PerformJump(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width);
  LookAround(stage, 0.0, stage.seconds(), 4.0);
  double t = stage.Uniform(0.05, 0.4);
  while (t < stage.seconds()) {
    const double chance = stage.Uniform(0.0, 1.0);
    if (chance < 0.32) {
      t = JumpUp(stage, t, false);
    } else if (chance < 0.45) {
      t = JumpUp(stage, t, true);
    } else if (chance < 0.60) {
      t = LongJump(stage, t);
    } else if (chance < 0.80) {
      t = StarJump(stage, t);
    } else if (chance < 0.90) {
      t = SideJump(stage, t);
    } else {
      t = HopSeveral(stage, t);
    }
    t += stage.Uniform(0.05, 0.7);
    const Spot spot = FinalSpot(stage);
    if (stage.Chance(0.3) || std::hypot(spot.x, spot.y) > 1800.0) {
      t = WalkTo(stage, t, NearbySpot(stage, 1300.0, 700.0));
    }
  }
}

void PerformSquat(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width * stage.Uniform(1.0, 1.7));
  LookAround(stage, 0.0, stage.seconds(), 4.0);
  double t = stage.Uniform(0.05, 0.5);
  for (int i = 0; t < stage.seconds(); ++i) {
    const double chance = i == 0 ? 0.0 : stage.Uniform(0.0, 1.0);
    if (chance < 0.5) {
      t = DoSquat(stage, t);
    } else if (chance < 0.76) {
      t = DoLunge(stage, t);
    } else if (chance < 0.88) {
      t = DoAllFours(stage, t);
    } else {
      t = DoKneel(stage, t);
    }
    t += stage.Uniform(0.05, 0.6);
    if (stage.Chance(0.2)) t = WalkTo(stage, t, NearbySpot(stage, 1200.0, 600.0));
  }
}

}  // namespace canonpose
