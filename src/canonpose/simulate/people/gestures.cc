// Gestures of people who stand, sit or walk.
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/moves.h"

namespace canonpose {
namespace {

void Home(Stage& stage, int side, double start, double duration) {
  MoveArm(stage, side, start, duration, HangingArm(stage));
}

// One posture of one or both arms, held for a while; the other arm may take another.
double HoldPose(Stage& stage, double t, double seconds) {
  const int one = stage.RandomSide();
  const auto pose = static_cast<ArmPose>(stage.rng().Index(static_cast<std::size_t>(ArmPose::kCount)));
  const double reach = stage.Beat(0.65);
  MoveArm(stage, one, t, reach, AnglesOf(stage, pose));
  const double chance = stage.Uniform(0.0, 1.0);
  if (chance < 0.45) {
    MoveArm(stage, 1 - one, t + stage.Uniform(0.0, 0.15), reach, AnglesOf(stage, pose));
  } else if (chance < 0.65) {
    MoveArm(stage, 1 - one, t, reach, RandomArm(stage));
  }
  return t + seconds;
}

double Wave(Stage& stage, double t, double seconds) {
  const int side = stage.RandomSide();
  const ArmPose poses[] = {ArmPose::kGoalpost, ArmPose::kUpDiagonal, ArmPose::kOverhead, ArmPose::kGuard};
  MoveArm(stage, side, t, stage.Beat(0.55), AnglesOf(stage, poses[stage.rng().Index(4)]));
  const double hertz = stage.Uniform(0.9, 2.4);
  const double size = RadFromDeg(stage.Uniform(10.0, 30.0)) / (0.5 + 0.5 * hertz);
  stage.Swing(Of(kShoulderTwist, side), t + 0.35, seconds, hertz, size, 0.0);
  stage.Swing(Of(kElbow, side), t + 0.35, seconds, hertz, 0.8 * size, 1.2);
  stage.Swing(Of(kShoulderAbd, side), t + 0.35, seconds, hertz, 0.5 * size, 0.5);
  if (stage.Chance(0.25)) {
    MoveArm(stage, 1 - side, t, stage.Beat(0.55), AnglesOf(stage, poses[stage.rng().Index(4)]));
    stage.Swing(Of(kShoulderTwist, 1 - side), t + 0.35, seconds, hertz, size, kPi);
  } else {
    Home(stage, 1 - side, t, 0.7);
  }
  return t + 0.4 + seconds;
}

double Clap(Stage& stage, double t, double seconds) {
  const double hertz = stage.Uniform(1.0, 2.6);
  const double height = RadFromDeg(stage.Uniform(35.0, 120.0));
  const double elbow = RadFromDeg(stage.Uniform(45.0, 85.0));
  const double size = RadFromDeg(stage.Uniform(9.0, 18.0));
  for (const int side : {kLeft, kRight}) {
    MoveArm(stage, side, t, 0.6, {height, RadFromDeg(10.0), RadFromDeg(28.0), elbow});
    stage.Swing(Of(kShoulderAbd, side), t + 0.4, seconds, hertz, 0.6 * size, 0.0);
    stage.Swing(Of(kShoulderTwist, side), t + 0.4, seconds, hertz, -size, 0.0);
  }
  return t + 0.4 + seconds;
}

double Point(Stage& stage, double t, double seconds) {
  const int side = stage.RandomSide();
  const double aside = RadFromDeg(stage.Uniform(-25.0, 95.0));
  const double raised = RadFromDeg(stage.Uniform(55.0, 125.0));
  const ArmAngles angles{raised * std::cos(aside), raised * std::sin(aside), RadFromDeg(stage.Uniform(-20.0, 50.0)),
                         RadFromDeg(stage.Uniform(4.0, 30.0))};
  MoveArm(stage, side, t, stage.Beat(0.5), angles);
  stage.MoveTo(kNeckTwist, t, 0.5, SideSign(side) * 0.65 * aside);
  stage.MoveTo(kTrunkTwist, t, 0.6, SideSign(side) * 0.25 * aside);
  stage.MoveTo(kNeckTwist, t + seconds, 0.5, 0.0);
  stage.MoveTo(kTrunkTwist, t + seconds, 0.6, 0.0);
  return t + seconds;
}

// Quick straight punches and hooks out of a guard, with a twist of the trunk.
double Box(Stage& stage, double t, double seconds) {
  for (const int side : {kLeft, kRight}) MoveArm(stage, side, t, 0.4, AnglesOf(stage, ArmPose::kGuard));
  const double end = t + 0.45 + seconds;
  t += 0.45;
  int side = stage.RandomSide();
  while (t < end) {
    const double out = stage.Uniform(0.20, 0.32);
    const double back = stage.Uniform(0.28, 0.45);
    const bool hook = stage.Chance(0.3);
    const ArmAngles guard = AnglesOf(stage, ArmPose::kGuard);
    const ArmAngles straight = AnglesOf(stage, ArmPose::kPointAhead);
    const ArmAngles bent{RadFromDeg(55.0), RadFromDeg(65.0), RadFromDeg(20.0), RadFromDeg(85.0)};
    MoveArm(stage, side, t, out, hook ? bent : straight);
    MoveArm(stage, side, t + out, back, guard);
    const double turn = -SideSign(side) * RadFromDeg(stage.Uniform(15.0, 38.0));
    stage.MoveTo(kTrunkTwist, t, out, turn);
    stage.MoveTo(kNeckTwist, t, out, -0.7 * turn);
    stage.MoveTo(kTrunkTwist, t + out, back, 0.0);
    stage.MoveTo(kNeckTwist, t + out, back, 0.0);
    stage.Bump(kPelvisZ, t, out + back, -stage.Tall(stage.Uniform(0.0, 0.04)));
    t += out + back * stage.Uniform(0.6, 1.2);
    if (stage.Chance(0.7)) side = 1 - side;
  }
  return t;
}

// Large circles, or both arms swinging up and down.
double Circle(Stage& stage, double t, double seconds) {
  const bool both = stage.Chance(0.6);
  const int one = stage.RandomSide();
  const double hertz = stage.Uniform(0.4, 1.0);
  const double size = RadFromDeg(stage.Uniform(25.0, 75.0));
  const double shift = stage.Chance(0.5) ? 0.0 : kPi;
  for (const int side : {kLeft, kRight}) {
    if (!both && side != one) continue;
    const double centre = RadFromDeg(stage.Uniform(60.0, 100.0));
    MoveArm(stage, side, t, 0.6, {0.4 * centre, 0.8 * centre, 0.0, RadFromDeg(stage.Uniform(5.0, 35.0))});
    const double phase = side == kLeft ? 0.0 : shift;
    stage.Swing(Of(kShoulderFlex, side), t + 0.3, seconds, hertz, size, phase);
    stage.Swing(Of(kShoulderAbd, side), t + 0.3, seconds, hertz, 0.8 * size, phase + kPi / 2);
  }
  return t + 0.3 + seconds;
}

// Hands that accompany talking.
double Talk(Stage& stage, double t, double seconds) {
  const double end = t + seconds;
  const bool both = stage.Chance(0.65);
  const int one = stage.RandomSide();
  while (t < end) {
    const double beat = stage.Beat(stage.Uniform(0.35, 0.8));
    for (const int side : {kLeft, kRight}) {
      if (!both && side != one) continue;
      ArmAngles angles = AnglesOf(stage, stage.Chance(0.7) ? ArmPose::kCarry : ArmPose::kBelly);
      angles.flex += RadFromDeg(stage.Uniform(-15.0, 30.0));
      angles.abd += RadFromDeg(stage.Uniform(-5.0, 25.0));
      angles.twist += RadFromDeg(stage.Uniform(-45.0, 25.0));
      angles.elbow += RadFromDeg(stage.Uniform(-25.0, 30.0));
      MoveArm(stage, side, t, beat, angles);
    }
    stage.MoveTo(kNeckFlex, t, beat, stage.style().head_pitch + RadFromDeg(stage.Uniform(-10.0, 14.0)));
    t += beat * stage.Uniform(0.75, 1.8);
  }
  return t;
}

double Shrug(Stage& stage, double t) {
  for (const int side : {kLeft, kRight}) {
    stage.Bump(Of(kShrug, side), t, 1.1, RadFromDeg(stage.Uniform(12.0, 25.0)));
    stage.Bump(Of(kShoulderTwist, side), t, 1.2, -RadFromDeg(stage.Uniform(20.0, 60.0)));
    stage.Bump(Of(kElbow, side), t, 1.2, RadFromDeg(stage.Uniform(30.0, 70.0)));
    stage.Bump(Of(kShoulderAbd, side), t, 1.2, RadFromDeg(stage.Uniform(5.0, 20.0)));
  }
  return t + 1.2;
}

double Anything(Stage& stage, double t, double seconds) {
  const bool mirrored = stage.Chance(0.4);
  const ArmAngles angles = RandomArm(stage);
  const double reach = stage.Beat(0.8);
  for (const int side : {kLeft, kRight}) MoveArm(stage, side, t, reach, mirrored ? angles : RandomArm(stage));
  return t + std::max(seconds * 0.7, reach);
}

// Legs and trunk of somebody who stands around.
void StandAbout(Stage& stage) {
  double t = stage.Uniform(0.5, 2.0);
  while (t < stage.seconds()) {
    const double duration = stage.Beat(0.9);
    if (stage.Chance(0.3)) {
      stage.MoveTo(kTrunkTwist, t, duration, RadFromDeg(stage.Uniform(-28.0, 28.0)));
      stage.MoveTo(kTrunkSide, t, duration, RadFromDeg(stage.Uniform(-14.0, 14.0)));
      stage.MoveTo(kTrunkFlex, t, duration, stage.style().trunk_lean + RadFromDeg(stage.Uniform(-10.0, 24.0)));
      stage.MoveTo(kPelvisPitch, t, duration, RadFromDeg(stage.Uniform(-6.0, 16.0)));
    }
    stage.MoveTo(kPelvisRoll, t, duration, RadFromDeg(stage.Uniform(-6.0, 6.0)));
    t += stage.Uniform(1.5, 4.5);
  }
}

}  // namespace

double MakeGesture(Stage& stage, double start, double seconds) {
  switch (stage.rng().Index(12)) {
    case 0:
    case 1:
    case 2:
      return HoldPose(stage, start, seconds);
    case 3:
      return Wave(stage, start, seconds);
    case 4:
      return Clap(stage, start, seconds);
    case 5:
      return Point(stage, start, seconds);
    case 6:
      return Circle(stage, start, seconds);
    case 7:
    case 8:
      return Talk(stage, start, seconds);
    case 9:
      return Shrug(stage, start);
    default:
      return Anything(stage, start, seconds);
  }
}

void PerformGesture(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width);
  LookAround(stage, 0.0, stage.seconds(), 2.5);
  StandAbout(stage);
  double t = stage.Uniform(-0.8, 0.6);
  double walk_at = stage.Uniform(2.0, 7.0);
  while (t < stage.seconds()) {
    const double seconds = stage.Uniform(0.8, 3.0);
    const double begun = t;
    t = stage.Chance(0.12) ? Box(stage, t, seconds) : MakeGesture(stage, t, seconds);
    if (t > walk_at) {
      // To another place, while the gesture continues.
      ShiftWeight(stage, kLeft, begun, 0.6, 0.0);
      const double arrived = WalkTo(stage, begun + 0.5, NearbySpot(stage, 1400.0, 900.0));
      walk_at = arrived + stage.Uniform(1.5, 6.0);
    } else if (stage.Chance(0.5)) {
      ShiftWeight(stage, stage.RandomSide(), t, 0.9, stage.Uniform(0.0, 0.75));
    }
    if (stage.Chance(0.3)) {
      for (const int side : {kLeft, kRight}) Home(stage, side, t, 0.7);
      t += stage.Uniform(0.4, 1.2);
    }
  }
}

}  // namespace canonpose
