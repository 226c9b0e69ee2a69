// Reaching for things, picking them up, throwing.
#include <algorithm>
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/moves.h"

namespace canonpose {
namespace {

void BendTo(Stage& stage, double start, double duration, double pitch, double flex, double side, double twist) {
  stage.MoveTo(kPelvisPitch, start, duration, pitch);
  stage.MoveTo(kTrunkFlex, start, duration, stage.style().trunk_lean + flex);
  stage.MoveTo(kTrunkSide, start, duration, side);
  stage.MoveTo(kTrunkTwist, start, duration, twist);
  stage.MoveTo(kNeckFlex, start, duration, stage.style().head_pitch - 0.15 * (pitch + flex));
}

void Straighten(Stage& stage, double start, double duration) {
  BendTo(stage, start, duration, 0.0, 0.0, 0.0, 0.0);
  stage.MoveTo(kPelvisZ, start, duration, -stage.Tall(0.01));
  stage.MoveTo(kSurge, start, duration, 0.0);
}

// A place in the world, relative to the pelvis.
struct Target {
  double ahead;
  double left;
  double height;
};

void HandTo(Stage& stage, int side, double start, double duration, const Target& target, bool jump_there) {
  const Spot spot = FinalSpot(stage);
  const double x = spot.x + std::cos(spot.yaw) * target.ahead - std::sin(spot.yaw) * target.left;
  const double y = spot.y + std::sin(spot.yaw) * target.ahead + std::cos(spot.yaw) * target.left;
  // As long as the hand's place has no weight, it may change abruptly.
  const double begin = jump_there ? start - 0.03 : start;
  const double took = jump_there ? 0.02 : duration;
  stage.MoveTo(Of(kHandX, side), begin, took, x);
  stage.MoveTo(Of(kHandY, side), begin, took, y);
  stage.MoveTo(Of(kHandZ, side), begin, took, target.height);
  if (jump_there) stage.MoveTo(Of(kHandWeight, side), start, duration, 1.0);
}

// Picks something up from the floor, by bending the knees or the back, with one hand or both, and may carry it.
double PickUp(Stage& stage, double t) {
  const bool both = stage.Chance(0.45);
  const int one = stage.RandomSide();
  const double knees = stage.Uniform(0.0, 1.0);
  const double down = stage.Beat(1.1);
  const double sink = stage.Tall(0.05 + 0.26 * knees);
  const double height = stage.Tall(stage.Uniform(0.02, 0.22));
  const double bend = RadFromDeg(92.0 - 42.0 * knees) * (1.0 - 0.8 * height / stage.Tall(0.6));
  const double ahead = stage.Tall(stage.Uniform(0.14, 0.26));
  const double left = stage.Tall(stage.Uniform(-0.14, 0.14));
  stage.MoveTo(kPelvisZ, t, down, -sink);
  stage.MoveTo(kSurge, t, down, -0.3 * sink - stage.Tall(0.05) * (1.0 - knees));
  BendTo(stage, t, down, 0.55 * bend, 0.55 * bend, 0.0, RadFromDeg(stage.Uniform(-20.0, 20.0)));
  const double hold = stage.Uniform(0.1, 0.7);
  const double up = stage.Beat(1.1);
  const bool carries = stage.Chance(0.5);
  for (const int side : {kLeft, kRight}) {
    if (!both && side != one) {
      if (stage.Chance(0.4)) MoveArm(stage, side, t, down, RandomArm(stage));
      continue;
    }
    const double across = both ? left + SideSign(side) * stage.Tall(0.07) : left;
    const double aside = std::clamp(SideSign(side) * across, stage.Tall(-0.05), stage.Tall(0.25)) * SideSign(side);
    MoveArm(stage, side, t, down, AnglesOf(stage, ArmPose::kLowForward));
    HandTo(stage, side, t, down, {ahead, aside, height}, true);
    stage.MoveTo(Of(kHandWeight, side), t + down + hold, 0.8 * up, 0.0);
    MoveArm(stage, side, t + down + hold, up, carries ? AnglesOf(stage, ArmPose::kCarry) : HangingArm(stage));
  }
  t += down + hold;
  Straighten(stage, t, up);
  t += up;
  if (carries) {
    t += stage.Uniform(0.1, 0.4);
    if (stage.Chance(0.4)) t = WalkTo(stage, t, NearbySpot(stage, 1300.0, 900.0));
    for (const int side : {kLeft, kRight}) MoveArm(stage, side, t, 0.7, HangingArm(stage));
    t += 0.5;
  }
  return t;
}

// Reaches for something at any height and on any side, with the trunk following.
double ReachOut(Stage& stage, double t) {
  const bool both = stage.Chance(0.25);
  const int one = stage.RandomSide();
  const double out = stage.Beat(0.85);
  const double height = stage.Uniform(-0.75, 1.0);  // of the direction from the shoulder
  const double aside = RadFromDeg(stage.Uniform(-50.0, 110.0));
  const double level = std::sqrt(std::max(0.0, 1.0 - height * height));
  const double low = std::max(0.0, -height);
  const double far = stage.Uniform(0.0, 1.0);
  const double sign = both ? 0.0 : SideSign(one);
  stage.MoveTo(kPelvisZ, t, out, -stage.Tall(0.01 + 0.10 * low * stage.Uniform(0.0, 1.0)));
  BendTo(stage, t, out, RadFromDeg(6.0 + 30.0 * low) * far, RadFromDeg(8.0 + 28.0 * low) * far * std::cos(aside),
         sign * RadFromDeg(24.0) * far * std::sin(aside),
         sign * RadFromDeg(34.0) * far * std::sin(aside - RadFromDeg(30.0)));
  if (height > 0.75 && stage.Chance(0.5)) {
    // On tiptoe.
    for (const int side : {kLeft, kRight}) {
      stage.MoveTo(Of(kFootPitch, side), t, out, RadFromDeg(28.0));
      stage.MoveTo(Of(kFootPitch, side), t + out + 0.5, 0.7, 0.0);
    }
    stage.MoveTo(kPelvisZ, t, out, stage.Tall(0.025));
  }
  if (far > 0.5 && !both) ShiftWeight(stage, std::sin(aside) >= 0.0 ? one : 1 - one, t, out, 0.6);
  stage.MoveTo(kNeckTwist, t, 0.7 * out, sign * 0.5 * aside);
  stage.MoveTo(kNeckFlex, t, out, stage.style().head_pitch - RadFromDeg(30.0) * height);
  const double reach = stage.Uniform(0.75, 0.98);
  for (const int side : {kLeft, kRight}) {
    if (!both && side != one) continue;
    const double own = both ? RadFromDeg(stage.Uniform(-5.0, 12.0)) : aside;
    const Eigen::Vector3d wrist = reach * Eigen::Vector3d(level * std::cos(own), level * std::sin(own), height) +
                                  Eigen::Vector3d(0.06, 0.04, 0.0);
    MoveArm(stage, side, t, out, ReachWith(stage.body(), wrist, {-0.3, 0.7, height > 0.5 ? 0.0 : -0.7}));
  }
  t += out + stage.Uniform(0.15, 0.9);
  const double back = stage.Beat(0.85);
  Straighten(stage, t, back);
  ShiftWeight(stage, one, t, back, 0.0);
  stage.MoveTo(kNeckTwist, t, back, 0.0);
  for (const int side : {kLeft, kRight}) {
    if (both || side == one) MoveArm(stage, side, t, back, HangingArm(stage));
  }
  return t + back * stage.Uniform(0.5, 1.0);
}

// The arm at the three key moments of a throw, and the motion of the trunk.
struct Throw {
  ArmAngles back;
  ArmAngles release;
  ArmAngles after;
  double twist_back;
  double twist_after;
  double side;
  double flex_back;
  double flex_after;
};

Throw OverArm(Stage& stage) {
  const double e = stage.style().energy;
  const double raised = RadFromDeg(stage.Uniform(-12.0, 22.0));
  return {{RadFromDeg(-18.0), RadFromDeg(92.0) + raised, RadFromDeg(-70.0), RadFromDeg(stage.Uniform(85.0, 110.0))},
          {RadFromDeg(70.0), RadFromDeg(75.0) + raised, RadFromDeg(10.0), RadFromDeg(22.0)},
          {RadFromDeg(62.0), RadFromDeg(-28.0), RadFromDeg(60.0), RadFromDeg(35.0)},
          -RadFromDeg(38.0) * e,
          RadFromDeg(36.0) * e,
          -RadFromDeg(14.0),
          -RadFromDeg(10.0),
          RadFromDeg(28.0) * e};
}

Throw UnderArm(Stage& stage) {
  return {{-RadFromDeg(stage.Uniform(35.0, 55.0)), RadFromDeg(12.0), RadFromDeg(0.0), RadFromDeg(10.0)},
          {RadFromDeg(50.0), RadFromDeg(5.0), RadFromDeg(-20.0), RadFromDeg(15.0)},
          {RadFromDeg(stage.Uniform(90.0, 130.0)), RadFromDeg(-5.0), RadFromDeg(-20.0), RadFromDeg(40.0)},
          -RadFromDeg(18.0),
          RadFromDeg(15.0),
          RadFromDeg(0.0),
          RadFromDeg(18.0),
          RadFromDeg(8.0)};
}

Throw SideArm(Stage& stage) {
  return {{RadFromDeg(-30.0), RadFromDeg(70.0), RadFromDeg(-40.0), RadFromDeg(stage.Uniform(25.0, 60.0))},
          {RadFromDeg(60.0), RadFromDeg(65.0), RadFromDeg(20.0), RadFromDeg(15.0)},
          {RadFromDeg(75.0), RadFromDeg(-20.0), RadFromDeg(50.0), RadFromDeg(45.0)},
          -RadFromDeg(45.0),
          RadFromDeg(42.0),
          RadFromDeg(0.0),
          RadFromDeg(5.0),
          RadFromDeg(12.0)};
}

double DoThrow(Stage& stage, double t) {
  const double chance = stage.Uniform(0.0, 1.0);
  const Throw way = chance < 0.5 ? OverArm(stage) : (chance < 0.8 ? UnderArm(stage) : SideArm(stage));
  const int side = stage.Chance(0.65) ? kRight : kLeft;
  const int other = 1 - side;
  const double sign = SideSign(side);
  const double wind = stage.Beat(0.75);
  const double fling = stage.Uniform(0.22, 0.32);
  const double follow = stage.Uniform(0.28, 0.42);
  const double stride = stage.Tall(stage.Uniform(0.10, 0.30));
  const double release = t + wind + 0.15 + fling;
  // Twists towards the throwing side: to the right for a right-handed throw.
  stage.MoveTo(kTrunkTwist, t, wind, sign * -way.twist_back);
  stage.MoveTo(kNeckTwist, t, wind, sign * 0.8 * way.twist_back);
  stage.MoveTo(kTrunkSide, t, wind, sign * way.side);
  stage.MoveTo(kTrunkFlex, t, wind, stage.style().trunk_lean + way.flex_back);
  MoveArm(stage, side, t, wind, way.back);
  MoveArm(stage, other, t, wind, stage.Chance(0.6) ? AnglesOf(stage, ArmPose::kPointAhead) : RandomArm(stage));
  if (stage.Chance(0.3)) {
    const double lift = RadFromDeg(stage.Uniform(35.0, 75.0));
    LiftLeg(stage, other, t + 0.1, 0.45, {lift, RadFromDeg(2.0), RadFromDeg(75.0)});
    LowerLeg(stage, other, t + wind - 0.1, 0.4);
  }
  StepBy(stage, other, t + wind - 0.2, 0.45, stride, 0.0, 0.0);
  MovePelvis(stage, t + wind - 0.2, 0.65, 0.55 * stride, 0.0);
  stage.Bump(kPelvisZ, t + wind - 0.3, 1.2, -stage.Tall(stage.Uniform(0.02, 0.07)));
  const double begin = t + wind + 0.05;
  stage.MoveTo(kTrunkTwist, begin, fling + 0.2, sign * -way.twist_after);
  stage.MoveTo(kNeckTwist, begin, fling + 0.2, sign * 0.8 * way.twist_after);
  stage.MoveTo(kTrunkSide, begin, fling + 0.2, 0.0);
  stage.MoveTo(kTrunkFlex, begin + 0.05, fling + follow, stage.style().trunk_lean + way.flex_after);
  stage.MoveTo(kPelvisPitch, begin + 0.05, fling + follow, 0.5 * way.flex_after);
  MoveArm(stage, side, release - fling, fling, way.release);
  MoveArm(stage, side, release - 0.06, follow, way.after);
  MoveArm(stage, other, begin, 0.5, HangingArm(stage));
  stage.MoveTo(Of(kFootPitch, side), begin, 0.5, RadFromDeg(stage.Uniform(10.0, 45.0)));
  t = release + follow + stage.Uniform(0.0, 0.4);
  const double back = stage.Beat(0.8);
  Straighten(stage, t, back);
  stage.MoveTo(kNeckTwist, t, back, 0.0);
  stage.MoveTo(Of(kFootPitch, side), t, 0.4, 0.0);
  MoveArm(stage, side, t, back, HangingArm(stage));
  return t + 0.6 * back;
}

// With both hands: from behind the head, from the chest, or catching.
double ThrowWithBoth(Stage& stage, double t) {
  const bool overhead = stage.Chance(0.55);
  const double wind = stage.Beat(0.7);
  const double fling = stage.Uniform(0.22, 0.32);
  const double knees = stage.Tall(stage.Uniform(0.02, 0.10));
  const ArmAngles back = AnglesOf(stage, overhead ? ArmPose::kHeadTop : ArmPose::kChest);
  const ArmAngles out = AnglesOf(stage, overhead ? ArmPose::kPointAhead : ArmPose::kForward);
  for (const int side : {kLeft, kRight}) {
    MoveArm(stage, side, t, wind, back);
    MoveArm(stage, side, t + wind + 0.1, fling, out);
    MoveArm(stage, side, t + wind + fling + 0.35, 0.8, HangingArm(stage));
  }
  stage.MoveTo(kTrunkFlex, t, wind, stage.style().trunk_lean - RadFromDeg(overhead ? 18.0 : 2.0));
  stage.MoveTo(kTrunkFlex, t + wind, fling + 0.2, stage.style().trunk_lean + RadFromDeg(stage.Uniform(5.0, 30.0)));
  stage.MoveTo(kTrunkFlex, t + wind + fling + 0.4, 0.8, stage.style().trunk_lean);
  stage.Bump(kPelvisZ, t + 0.2, wind, -knees);
  return t + wind + fling + 0.9;
}

}  // namespace

void PerformReach(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width * stage.Uniform(0.9, 1.4));
  LookAround(stage, 0.0, stage.seconds(), 5.0);
  double t = stage.Uniform(0.05, 0.5);
  while (t < stage.seconds()) {
    t = stage.Chance(0.35) ? PickUp(stage, t) : ReachOut(stage, t);
    if (stage.Chance(0.35)) t = WalkTo(stage, t + 0.1, NearbySpot(stage, 1300.0, 900.0));
  }
}

void PerformThrow(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width * stage.Uniform(1.0, 1.5));
  LookAround(stage, 0.0, stage.seconds(), 5.0);
  double t = stage.Uniform(0.1, 0.5);
  while (t < stage.seconds()) {
    t = stage.Chance(0.78) ? DoThrow(stage, t) : ThrowWithBoth(stage, t);
    t += 0.1;
    const double chance = stage.Uniform(0.0, 1.0);
    if (chance < 0.3) {
      t = PickUp(stage, t);
    } else {
      t = WalkTo(stage, t, NearbySpot(stage, 1200.0, chance < 0.6 ? 300.0 : 800.0));
    }
  }
}

}  // namespace canonpose
