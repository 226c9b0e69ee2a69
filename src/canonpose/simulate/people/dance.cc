// Dance and exercise: everything a body can do, in random combinations.
#include <algorithm>
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/moves.h"

namespace canonpose {
namespace {

void TrunkTo(Stage& stage, double start, double duration, double pitch, double flex, double side, double twist) {
  stage.MoveTo(kPelvisPitch, start, duration, pitch);
  stage.MoveTo(kTrunkFlex, start, duration, stage.style().trunk_lean + flex);
  stage.MoveTo(kTrunkSide, start, duration, side);
  stage.MoveTo(kTrunkTwist, start, duration, twist);
}

// Upper body: arms and trunk move to new positions beat after beat.
void DanceAbove(Stage& stage, double from, double to) {
  double t = from;
  while (t < to) {
    const double beat = stage.Beat(stage.Uniform(0.45, 1.3));
    const double chance = stage.Uniform(0.0, 1.0);
    const ArmAngles mirrored = RandomArm(stage);
    for (const int side : {kLeft, kRight}) {
      const auto pose = static_cast<ArmPose>(stage.rng().Index(static_cast<std::size_t>(ArmPose::kCount)));
      if (chance < 0.30) {
        MoveArm(stage, side, t, beat, mirrored);
      } else if (chance < 0.65) {
        MoveArm(stage, side, t + stage.Uniform(0.0, 0.2), beat, RandomArm(stage));
      } else if (chance < 0.85) {
        MoveArm(stage, side, t, beat, AnglesOf(stage, pose));
      } else {
        stage.Swing(Of(kShoulderFlex, side), t, 2.0 * beat, stage.Uniform(0.6, 1.4), RadFromDeg(30.0), SideSign(side));
        stage.Swing(Of(kElbow, side), t, 2.0 * beat, stage.Uniform(0.6, 1.4), RadFromDeg(20.0), 0.5);
      }
      stage.MoveTo(Of(kShrug, side), t, beat, RadFromDeg(stage.Uniform(-5.0, 12.0)));
    }
    if (stage.Chance(0.6)) {
      stage.MoveTo(kNeckFlex, t, beat, RadFromDeg(stage.Uniform(-32.0, 35.0)));
      stage.MoveTo(kNeckTwist, t, beat, RadFromDeg(stage.Uniform(-55.0, 55.0)));
      stage.MoveTo(kNeckSide, t, beat, RadFromDeg(stage.Uniform(-24.0, 24.0)));
    }
    t += beat * stage.Uniform(0.85, 1.5);
  }
}

double BendTrunk(Stage& stage, double t) {
  const double beat = stage.Beat(stage.Uniform(0.7, 1.4));
  const double chance = stage.Uniform(0.0, 1.0);
  const double e = stage.style().energy;
  if (chance < 0.35) {
    // Deep forward.
    stage.MoveTo(kSurge, t, beat, -stage.Tall(0.05));
    TrunkTo(stage, t, beat, e * RadFromDeg(stage.Uniform(15.0, 65.0)), e * RadFromDeg(stage.Uniform(10.0, 55.0)),
            RadFromDeg(stage.Uniform(-15.0, 15.0)), RadFromDeg(stage.Uniform(-30.0, 30.0)));
  } else if (chance < 0.50) {
    // Back.
    stage.MoveTo(kSurge, t, beat, stage.Tall(0.03));
    TrunkTo(stage, t, beat, RadFromDeg(stage.Uniform(-28.0, 0.0)), -RadFromDeg(stage.Uniform(10.0, 42.0)),
            RadFromDeg(stage.Uniform(-12.0, 12.0)), RadFromDeg(stage.Uniform(-18.0, 18.0)));
  } else {
    const double side = RadFromDeg(stage.Uniform(-36.0, 36.0));
    TrunkTo(stage, t, beat, RadFromDeg(stage.Uniform(-8.0, 18.0)), RadFromDeg(stage.Uniform(-15.0, 28.0)), side,
            RadFromDeg(stage.Uniform(-42.0, 42.0)));
    stage.MoveTo(kPelvisRoll, t, beat, RadFromDeg(stage.Uniform(-10.0, 10.0)));
  }
  if (stage.Chance(0.5)) stage.MoveTo(kPelvisZ, t, beat, -stage.Tall(stage.Uniform(0.01, 0.14)));
  return t + beat * stage.Uniform(0.9, 1.4);
}

double Upright(Stage& stage, double t) {
  const double beat = stage.Beat(0.7);
  TrunkTo(stage, t, beat, 0.0, 0.0, 0.0, 0.0);
  stage.MoveTo(kPelvisRoll, t, beat, 0.0);
  stage.MoveTo(kPelvisZ, t, beat, -stage.Tall(0.012));
  stage.MoveTo(kSurge, t, beat, 0.0);
  stage.MoveTo(kSway, t, beat, 0.0);
  return t + 0.8 * beat;
}

LegPose RandomLeg(Stage& stage) {
  const double chance = stage.Uniform(0.0, 1.0);
  if (chance < 0.30) {
    // Kick or straight leg to the front.
    return {RadFromDeg(stage.Uniform(30.0, 100.0)), RadFromDeg(stage.Uniform(-5.0, 25.0)),
            RadFromDeg(stage.Uniform(3.0, 35.0)), RadFromDeg(stage.Uniform(0.0, 45.0)),
            RadFromDeg(stage.Uniform(-5.0, 20.0))};
  }
  if (chance < 0.52) {
    // Knee up.
    return {RadFromDeg(stage.Uniform(15.0, 65.0)), RadFromDeg(stage.Uniform(-5.0, 22.0)),
            RadFromDeg(stage.Uniform(70.0, 130.0)), RadFromDeg(stage.Uniform(0.0, 45.0)),
            RadFromDeg(stage.Uniform(-10.0, 20.0))};
  }
  if (chance < 0.72) {
    // To the side.
    return {RadFromDeg(stage.Uniform(-10.0, 30.0)), RadFromDeg(stage.Uniform(25.0, 65.0)),
            RadFromDeg(stage.Uniform(3.0, 60.0)), RadFromDeg(stage.Uniform(0.0, 45.0)),
            RadFromDeg(stage.Uniform(0.0, 35.0))};
  }
  if (chance < 0.85) {
    // Sole at the other knee: the tree pose.
    return {RadFromDeg(stage.Uniform(30.0, 42.0)), RadFromDeg(14.0), RadFromDeg(stage.Uniform(105.0, 125.0)),
            RadFromDeg(35.0), RadFromDeg(stage.Uniform(35.0, 60.0))};
  }
  // Behind.
  return {-RadFromDeg(stage.Uniform(15.0, 34.0)), RadFromDeg(stage.Uniform(0.0, 12.0)),
          RadFromDeg(stage.Uniform(5.0, 95.0)), RadFromDeg(stage.Uniform(20.0, 50.0))};
}

// On one leg for a moment, or long enough to move the other leg.
double BalanceOnOne(Stage& stage, double t) {
  const int side = stage.RandomSide();
  const double up = stage.Beat(stage.Uniform(0.35, 0.8));
  const LegPose pose = RandomLeg(stage);
  LiftLeg(stage, side, t + 0.2, up, pose);
  if (pose.flex < 0.0 || (pose.abd > RadFromDeg(25.0) && stage.Chance(0.5))) {
    // The trunk tips in the direction opposite to the leg.
    const double tip = RadFromDeg(stage.Uniform(15.0, 60.0));
    if (pose.flex < 0.0) {
      stage.MoveTo(kPelvisPitch, t, up, tip);
      stage.MoveTo(kPelvisPitch, t + up + 1.6, 0.8, 0.0);
    } else {
      stage.MoveTo(kPelvisRoll, t, up, -SideSign(side) * 0.5 * tip);
      stage.MoveTo(kPelvisRoll, t + up + 1.6, 0.8, 0.0);
    }
  }
  t += 0.2 + up;
  const int moves = static_cast<int>(stage.rng().Index(3));
  for (int i = 0; i < moves; ++i) {
    const double beat = stage.Beat(0.7);
    MoveLeg(stage, side, t, beat, RandomLeg(stage));
    if (stage.Chance(0.4)) stage.Bump(kPelvisZ, t, 1.5 * beat, -stage.Tall(stage.Uniform(0.02, 0.10)));
    t += beat;
  }
  t += stage.Chance(0.4) ? stage.Uniform(0.2, 1.5) : 0.0;
  const double down = stage.Beat(0.55);
  LowerLeg(stage, side, t, down);
  return t + down + 0.3;
}

// Several fast kicks, left and right.
double KickSeveral(Stage& stage, double t) {
  int side = stage.RandomSide();
  const int count = 1 + static_cast<int>(stage.rng().Index(3));
  for (int i = 0; i < count; ++i) {
    const double up = stage.Uniform(0.32, 0.5);
    LiftLeg(stage, side, t + 0.15, up,
            {RadFromDeg(stage.Uniform(45.0, 105.0)), RadFromDeg(stage.Uniform(-8.0, 25.0)),
             RadFromDeg(stage.Uniform(5.0, 25.0)), RadFromDeg(40.0)});
    stage.Bump(Of(kKnee, side), t + 0.1, up, RadFromDeg(stage.Uniform(20.0, 60.0)));
    stage.Bump(kPelvisPitch, t + 0.1, 2.0 * up, -RadFromDeg(stage.Uniform(0.0, 18.0)));
    LowerLeg(stage, side, t + 0.2 + up, 0.45);
    t += up + 0.95;
    if (stage.Chance(0.7)) side = 1 - side;
  }
  return t;
}

double Plies(Stage& stage, double t) {
  const int count = 1 + static_cast<int>(stage.rng().Index(4));
  const double twist = RadFromDeg(stage.Uniform(0.0, 30.0));
  for (int i = 0; i < count; ++i) {
    const double beat = stage.Beat(stage.Uniform(0.5, 1.1));
    stage.Bump(kPelvisZ, t, beat, -stage.Tall(stage.Uniform(0.04, 0.24)));
    stage.Bump(kPelvisPitch, t, beat, RadFromDeg(stage.Uniform(0.0, 25.0)));
    stage.Bump(kSway, t, beat, stage.Tall(stage.Uniform(-0.05, 0.05)));
    for (const int side : {kLeft, kRight}) stage.Bump(Of(kLegTwist, side), t, beat, twist);
    t += 0.9 * beat;
  }
  return t;
}

// Hips that swing and circle.
double SwingHips(Stage& stage, double t) {
  const double seconds = stage.Uniform(1.5, 4.0);
  const double hertz = stage.Uniform(0.5, 1.5);
  const double phase = stage.Uniform(0.0, 2 * kPi);
  const double size = stage.style().energy * stage.Uniform(0.5, 1.2);
  stage.Swing(kSway, t, seconds, hertz, size * stage.Tall(0.035), phase);
  stage.Swing(kSurge, t, seconds, hertz, size * stage.Tall(0.02), phase + kPi / 2);
  stage.Swing(kPelvisRoll, t, seconds, hertz, size * RadFromDeg(8.0), phase + kPi);
  stage.Swing(kTrunkSide, t, seconds, hertz, size * RadFromDeg(9.0), phase);
  stage.Swing(kTrunkTwist, t, seconds, 0.5 * hertz, size * RadFromDeg(18.0), phase);
  stage.MoveTo(kPelvisZ, t, 0.6, -stage.Tall(stage.Uniform(0.01, 0.09)));
  stage.MoveTo(kPelvisZ, t + seconds - 0.5, 0.6, -stage.Tall(0.012));
  return t + seconds;
}

// Feet wide apart, weight on one bent leg and then the other.
double WideStance(Stage& stage, double t) {
  const double apart = stage.Tall(stage.Uniform(0.12, 0.26));
  const double sink = stage.Tall(stage.Uniform(0.08, 0.22));
  for (const int side : {kLeft, kRight}) {
    const double turn = SideSign(side) * RadFromDeg(stage.Uniform(0.0, 28.0));
    MovePelvis(stage, t, 0.5, 0.0, SideSign(side) * 0.3 * apart);
    StepBy(stage, side, t, 0.5, 0.0, SideSign(side) * apart, turn);
    MovePelvis(stage, t + 0.45, 0.4, 0.0, -SideSign(side) * 0.3 * apart);
    t += 0.5;
  }
  stage.MoveTo(kPelvisZ, t, 0.8, -sink);
  const int shifts = 1 + static_cast<int>(stage.rng().Index(3));
  for (int i = 0; i < shifts; ++i) {
    const double beat = stage.Beat(1.0);
    ShiftWeight(stage, stage.RandomSide(), t, beat, stage.Uniform(0.2, 0.75));
    stage.MoveTo(kTrunkSide, t, beat, RadFromDeg(stage.Uniform(-34.0, 34.0)));
    stage.MoveTo(kTrunkTwist, t, beat, RadFromDeg(stage.Uniform(-38.0, 38.0)));
    stage.MoveTo(kTrunkFlex, t, beat, RadFromDeg(stage.Uniform(-15.0, 50.0)));
    stage.MoveTo(kPelvisPitch, t, beat, RadFromDeg(stage.Uniform(-5.0, 45.0)));
    t += beat * stage.Uniform(0.9, 1.4);
  }
  Upright(stage, t);
  return WalkTo(stage, t + 0.2, FinalSpot(stage));
}

// A long step with the front or the back leg deeply bent, arms anywhere.
double Lunge(Stage& stage, double t) {
  const int side = stage.RandomSide();
  const double length = stage.Tall(stage.Uniform(0.3, 0.5));
  const double sink = stage.Tall(stage.Uniform(0.10, 0.24));
  StepBy(stage, side, t, 0.6, length, 0.0, 0.0);
  MovePelvis(stage, t + 0.1, 0.8, stage.Uniform(0.45, 0.65) * length, 0.0);
  stage.MoveBy(kPelvisZ, t + 0.25, 0.7, -sink);
  stage.MoveTo(Of(kFootPitch, 1 - side), t + 0.3, 0.5, RadFromDeg(stage.Uniform(35.0, 60.0)));
  t += 0.95;
  const double hold = stage.Uniform(0.2, 1.5);
  TrunkTo(stage, t - 0.4, 0.8, RadFromDeg(stage.Uniform(-6.0, 35.0)), RadFromDeg(stage.Uniform(-25.0, 35.0)),
          RadFromDeg(stage.Uniform(-25.0, 25.0)), RadFromDeg(stage.Uniform(-45.0, 45.0)));
  t += hold;
  stage.MoveBy(kPelvisZ, t, 0.7, sink);
  stage.MoveTo(Of(kFootPitch, 1 - side), t, 0.5, 0.0);
  return WalkTo(stage, t + 0.1, FinalSpot(stage));
}

double Leap(Stage& stage, double t) {
  Jump jump{};
  jump.height = stage.Tall(stage.Uniform(0.06, 0.18));
  jump.crouch = stage.Tall(stage.Uniform(0.08, 0.18));
  jump.turn = stage.Chance(0.4) ? RadFromDeg(stage.Uniform(-200.0, 200.0)) : 0.0;
  jump.arms_swing = false;
  jump.left_leg = {RadFromDeg(stage.Uniform(-25.0, 45.0)), RadFromDeg(stage.Uniform(2.0, 30.0)),
                   RadFromDeg(stage.Uniform(8.0, 95.0)), RadFromDeg(40.0)};
  jump.right_leg = {RadFromDeg(stage.Uniform(-25.0, 45.0)), RadFromDeg(stage.Uniform(2.0, 30.0)),
                    RadFromDeg(stage.Uniform(8.0, 95.0)), RadFromDeg(40.0)};
  return DoJump(stage, t, jump);
}

// As on a ladder: alternately one hand high and the other knee up.
double Climb(Stage& stage, double t) {
  int side = stage.RandomSide();
  const int count = 2 + static_cast<int>(stage.rng().Index(4));
  const double lean = RadFromDeg(stage.Uniform(-20.0, 25.0));
  stage.MoveTo(kPelvisPitch, t, 0.6, lean);
  for (int i = 0; i < count; ++i) {
    const double up = stage.Beat(0.6);
    LiftLeg(stage, side, t + 0.15, up,
            {RadFromDeg(stage.Uniform(25.0, 62.0)), RadFromDeg(stage.Uniform(0.0, 18.0)),
             RadFromDeg(stage.Uniform(60.0, 115.0)), RadFromDeg(5.0)});
    ArmAngles high = AnglesOf(stage, stage.Chance(0.6) ? ArmPose::kOverhead : ArmPose::kUpDiagonal);
    high.elbow += RadFromDeg(stage.Uniform(0.0, 50.0));
    MoveArm(stage, 1 - side, t + 0.1, up, high);
    MoveArm(stage, side, t + 0.1, up,
            {RadFromDeg(stage.Uniform(30.0, 100.0)), RadFromDeg(stage.Uniform(5.0, 40.0)),
             RadFromDeg(stage.Uniform(-20.0, 30.0)), RadFromDeg(stage.Uniform(60.0, 125.0))});
    stage.MoveTo(kTrunkSide, t, up, SideSign(side) * RadFromDeg(stage.Uniform(4.0, 20.0)));
    stage.MoveTo(kNeckFlex, t, up, -RadFromDeg(stage.Uniform(5.0, 40.0)));
    t += 0.15 + up;
    LowerLeg(stage, side, t, stage.Beat(0.5));
    t += 0.75;
    side = 1 - side;
  }
  return Upright(stage, t);
}

double StepAbout(Stage& stage, double t) {
  Spot spot = NearbySpot(stage, 1400.0, 800.0);
  if (stage.Chance(0.35)) spot.yaw = stage.Final(kPelvisYaw) + RadFromDeg(170.0) * SideSign(stage.RandomSide());
  return WalkTo(stage, t, spot);
}

}  // namespace

void PerformDance(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width * stage.Uniform(1.0, 1.5));
  DanceAbove(stage, stage.Uniform(-0.8, 0.2), stage.seconds());
  double t = stage.Uniform(0.05, 0.5);
  while (t < stage.seconds()) {
    const double chance = stage.Uniform(0.0, 1.0);
    if (chance < 0.24) {
      t = BendTrunk(stage, t);
      if (stage.Chance(0.4)) t = BendTrunk(stage, t);
      t = Upright(stage, t);
    } else if (chance < 0.32) {
      t = Climb(stage, t);
    } else if (chance < 0.46) {
      t = BalanceOnOne(stage, t);
    } else if (chance < 0.53) {
      t = KickSeveral(stage, t);
    } else if (chance < 0.62) {
      t = Plies(stage, t);
    } else if (chance < 0.70) {
      t = SwingHips(stage, t);
    } else if (chance < 0.78) {
      t = WideStance(stage, t);
    } else if (chance < 0.85) {
      t = Upright(stage, Lunge(stage, t));
    } else if (chance < 0.91) {
      t = Leap(stage, t);
    } else {
      t = StepAbout(stage, t);
    }
  }
}

}  // namespace canonpose
