// Sitting down on chairs and on the ground, sitting, and standing up.
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/moves.h"

namespace canonpose {
namespace {

void Lean(Stage& stage, double start, double duration, double pitch, double flex) {
  stage.MoveTo(kPelvisPitch, start, duration, pitch);
  stage.MoveTo(kTrunkFlex, start, duration, flex);
  stage.MoveTo(kNeckFlex, start, duration, stage.style().head_pitch - 0.45 * (pitch + flex));
}

// Wrists on the thighs, which keep the wrists out of themselves.
ArmAngles HandOnThigh(Stage& stage) {
  const double arm = stage.body().arm(kLeft);
  const double trunk = stage.body().trunk;
  const Eigen::Vector3d wrist(stage.Uniform(0.10, 0.19) * stage.body().stature / arm,
                              stage.Uniform(-0.05, 0.02) * stage.body().stature / arm,
                              -(trunk - stage.Tall(0.055)) / arm);
  return ReachWith(stage.body(), wrist, {-0.8, 0.7, 0.0});
}

void HandsToLap(Stage& stage, double t) {
  for (const int side : {kLeft, kRight}) MoveArm(stage, side, t, stage.Beat(0.8), HandOnThigh(stage));
}

// One leg over the other, or the ankle on the other knee; returns the time at which the foot is down again.
void CrossLegs(Stage& stage, double t, double until) {
  const int side = stage.RandomSide();
  stage.MoveTo(Of(kLegFlex, side), t - 0.03, 0.03, RadFromDeg(48.0) + stage.Final(kPelvisPitch));
  stage.MoveTo(Of(kLegAbd, side), t - 0.03, 0.03, RadFromDeg(3.0));
  stage.MoveTo(Of(kKnee, side), t - 0.03, 0.03, RadFromDeg(88.0));
  stage.MoveTo(Of(kFree, side), t, 0.5, 1.0);
  const double duration = stage.Beat(1.0);
  const double pitch = stage.Final(kPelvisPitch);
  const bool figure_four = stage.Chance(0.4);
  if (figure_four) {
    MoveLeg(stage, side, t + 0.05, duration,
            {RadFromDeg(74.0) + pitch, RadFromDeg(-12.0), RadFromDeg(108.0), RadFromDeg(10.0),
             RadFromDeg(stage.Uniform(48.0, 60.0))});
  } else {
    MoveLeg(stage, side, t + 0.05, duration,
            {RadFromDeg(70.0) + pitch, RadFromDeg(stage.Uniform(-22.0, -15.0)), RadFromDeg(stage.Uniform(70.0, 85.0)),
             RadFromDeg(28.0), RadFromDeg(-6.0)});
    stage.Swing(Of(kKnee, side), t + duration, std::max(0.5, until - t - duration), stage.Uniform(0.4, 1.5),
                RadFromDeg(4.0), 0.0);
  }
  stage.Bump(Of(kLegFlex, side), t + 0.05, duration, RadFromDeg(14.0));
  MoveLeg(stage, side, until, 0.8, {RadFromDeg(50.0) + pitch, RadFromDeg(4.0), RadFromDeg(88.0), RadFromDeg(5.0)});
  stage.Bump(Of(kLegFlex, side), until, 0.8, RadFromDeg(14.0));
  stage.MoveTo(Of(kFree, side), until + 0.3, 0.7, 0.0);
}

// What people do on a chair.
void BeSeated(Stage& stage, double t, double until) {
  double next_legs = t + stage.Uniform(0.2, 2.0);
  double hands_free = t;
  while (t < until) {
    const double chance = stage.Uniform(0.0, 1.0);
    if (chance < 0.4) {
      t = MakeGesture(stage, std::max(t, hands_free), stage.Uniform(0.8, 2.0));
    } else if (chance < 0.6) {
      HandsToLap(stage, t);
      t += stage.Uniform(0.8, 1.6);
    } else {
      // Bends forward, leans back, turns.
      const double duration = stage.Beat(1.0);
      Lean(stage, t, duration, RadFromDeg(stage.Uniform(-22.0, 18.0)), RadFromDeg(stage.Uniform(-6.0, 42.0)));
      stage.MoveTo(kTrunkTwist, t, duration, RadFromDeg(stage.Uniform(-32.0, 32.0)));
      stage.MoveTo(kTrunkSide, t, duration, RadFromDeg(stage.Uniform(-16.0, 16.0)));
      t += duration * stage.Uniform(0.7, 1.5);
    }
    hands_free = t;
    if (t > next_legs && t < until - 2.5) {
      if (stage.Chance(0.5)) {
        const double uncross = std::min(t + stage.Uniform(1.8, 5.0), until - 0.6);
        CrossLegs(stage, t, uncross);
        next_legs = uncross + 1.2;
      } else {
        const int side = stage.RandomSide();
        const double ahead = stage.Tall(stage.Uniform(-0.06, 0.13));
        StepBy(stage, side, t, 0.5, ahead, SideSign(side) * stage.Tall(stage.Uniform(0.0, 0.05)), 0.0);
        next_legs = t + stage.Uniform(0.7, 2.5);
      }
    }
  }
}

void FeetHome(Stage& stage, double t) {
  const Spot spot = FinalSpot(stage);
  double at = t;
  for (const int side : {kLeft, kRight}) {
    const double across = SideSign(side) * stage.style().stance_half_width;
    const double dx = spot.x - std::sin(spot.yaw) * across - stage.Final(Of(kFootX, side));
    const double dy = spot.y + std::cos(spot.yaw) * across - stage.Final(Of(kFootY, side));
    const double ahead = std::cos(spot.yaw) * dx + std::sin(spot.yaw) * dy;
    const double left = -std::sin(spot.yaw) * dx + std::cos(spot.yaw) * dy;
    if (std::hypot(ahead, left) > 15.0) StepBy(stage, side, at, 0.45, ahead, left, 0.0);
    at += 0.3;
  }
}

double SitOnChair(Stage& stage, double t, bool already) {
  const double seat = stage.Tall(stage.Uniform(0.245, 0.33)) + stage.Tall(0.045);
  const double back = 0.82 * stage.body().thigh[kLeft];
  const double down = already ? 0.02 : stage.Beat(1.3);
  if (already) t = -0.05;
  const double home = stage.Final(kPelvisZ);
  stage.MoveTo(kPelvisZ, t, down, seat - stage.body().standing_hip_height());
  stage.MoveTo(kSurge, t - (already ? 0.0 : 0.1), down, -back);
  const double pitch = RadFromDeg(stage.Uniform(-18.0, 6.0));
  Lean(stage, t + 0.3 * down, 0.9 * down, pitch, RadFromDeg(stage.Uniform(4.0, 26.0)));
  if (!already) {
    stage.Bump(kPelvisPitch, t - 0.15, 1.15 * down, RadFromDeg(stage.Uniform(25.0, 48.0)));
    stage.Bump(kTrunkFlex, t - 0.15, 1.15 * down, RadFromDeg(stage.Uniform(0.0, 15.0)));
  }
  HandsToLap(stage, t + 0.3 * down);
  t += down + 0.2;
  const double until = t + stage.Uniform(4.0, 12.0);
  BeSeated(stage, t, until);
  t = until + 0.9;
  FeetHome(stage, t);
  t += 0.6;
  const double up = stage.Beat(1.2);
  stage.MoveTo(kTrunkTwist, t, 0.5, 0.0);
  stage.MoveTo(kTrunkSide, t, 0.5, 0.0);
  stage.Bump(kPelvisPitch, t - 0.1, 1.15 * up, RadFromDeg(stage.Uniform(30.0, 50.0)));
  Lean(stage, t + 0.2, up, 0.0, stage.style().trunk_lean);
  stage.MoveTo(kPelvisZ, t + 0.15, up, home);
  stage.MoveTo(kSurge, t + 0.10, up, 0.0);
  for (const int side : {kLeft, kRight}) MoveArm(stage, side, t + 0.3, up, HangingArm(stage));
  return t + up + 0.2;
}

struct GroundSeat {
  LegPose left;
  LegPose right;
  double pitch;
  double flex;
};

GroundSeat RandomGroundSeat(Stage& stage) {
  const double chance = stage.Uniform(0.0, 1.0);
  const double pitch = RadFromDeg(stage.Uniform(-25.0, 2.0));
  if (chance < 0.35) {
    // Tailor's seat.
    const LegPose leg{RadFromDeg(86.0), RadFromDeg(6.0), RadFromDeg(stage.Uniform(108.0, 124.0)), RadFromDeg(25.0),
                      RadFromDeg(62.0)};
    return {leg,
            {leg.flex, leg.abd + RadFromDeg(4.0), leg.knee - RadFromDeg(16.0), leg.ankle, leg.twist},
            pitch,
            RadFromDeg(25.0)};
  }
  // Straight legs, one of them sometimes bent.
  const double spread = RadFromDeg(stage.Uniform(3.0, 28.0));
  const LegPose straight{RadFromDeg(87.0), spread, RadFromDeg(stage.Uniform(5.0, 20.0)), RadFromDeg(15.0),
                         RadFromDeg(10.0)};
  const LegPose bent{RadFromDeg(86.0), RadFromDeg(6.0), RadFromDeg(stage.Uniform(70.0, 110.0)), RadFromDeg(20.0),
                     RadFromDeg(stage.Uniform(-5.0, 15.0))};
  const bool left = stage.Chance(0.35);
  const bool right = stage.Chance(0.35);
  return {left ? bent : straight, right ? bent : straight, pitch, RadFromDeg(stage.Uniform(5.0, 40.0))};
}

// The legs' angles are relative to the pelvis, but the ground does not pitch with it.
LegPose OnGround(LegPose pose, double pitch) {
  pose.flex += pitch;
  return pose;
}

// From sitting on the ground down onto the back, with arms and legs moving, and up again.
double LieDown(Stage& stage, double t) {
  const double down = stage.Beat(1.6);
  const double pitch = -RadFromDeg(stage.Uniform(74.0, 84.0));
  Lean(stage, t, down, pitch, RadFromDeg(stage.Uniform(0.0, 8.0)));
  stage.MoveTo(kNeckFlex, t, down, RadFromDeg(stage.Uniform(-5.0, 25.0)));
  const double until = t + down + stage.Uniform(2.0, 6.0);
  for (double g = t; g < until - 1.2;) {
    const double duration = g > t ? stage.Beat(1.1) : down;
    for (const int side : {kLeft, kRight}) {
      const double bent =
          stage.Chance(0.5) ? RadFromDeg(stage.Uniform(50.0, 110.0)) : RadFromDeg(stage.Uniform(5.0, 30.0));
      const double raised = stage.Chance(0.25) ? RadFromDeg(stage.Uniform(10.0, 75.0)) : 0.0;
      MoveLeg(stage, side, g, duration,
              {RadFromDeg(88.0) + pitch + raised, RadFromDeg(stage.Uniform(2.0, 22.0)), bent, RadFromDeg(25.0),
               RadFromDeg(stage.Uniform(-5.0, 30.0))});
      MoveArm(stage, side, g, duration, stage.Chance(0.5) ? RandomArm(stage) : HangingArm(stage));
    }
    stage.MoveTo(kNeckTwist, g, duration, RadFromDeg(stage.Uniform(-40.0, 40.0)));
    g += duration * stage.Uniform(0.9, 1.6);
  }
  const double up = stage.Beat(1.5);
  Lean(stage, until, up, RadFromDeg(-8.0), RadFromDeg(30.0));
  stage.Bump(kTrunkFlex, until - 0.2, up, RadFromDeg(30.0));
  stage.MoveTo(kNeckTwist, until, up, 0.0);
  for (const int side : {kLeft, kRight}) {
    MoveLeg(stage, side, until, up, {RadFromDeg(80.0), RadFromDeg(6.0), RadFromDeg(60.0), RadFromDeg(20.0)});
    MoveArm(stage, side, until, up, AnglesOf(stage, ArmPose::kForward));
  }
  return until + up;
}

double SitOnGround(Stage& stage, double t) {
  const double down = stage.Beat(1.7);
  const double home = stage.Final(kPelvisZ);
  const double floor = stage.Tall(0.058) - stage.body().standing_hip_height();
  const double back = stage.Tall(0.26);
  stage.MoveTo(kPelvisZ, t, down, floor);
  stage.MoveTo(kSurge, t + 0.15, down - 0.1, -back);
  Lean(stage, t + 0.4 * down, 0.6 * down, RadFromDeg(-8.0), RadFromDeg(30.0));
  stage.Bump(kPelvisPitch, t, down, RadFromDeg(stage.Uniform(20.0, 38.0)));
  for (const int side : {kLeft, kRight}) {
    // Hands forward for balance, then to the knees.
    MoveArm(stage, side, t, 0.9, AnglesOf(stage, ArmPose::kForward));
    MoveArm(stage, side, t + 0.7 * down, 1.0, AnglesOf(stage, ArmPose::kLowForward));
  }
  t += down + stage.Uniform(0.2, 1.2);
  const double until = t + stage.Uniform(2.0, 6.0);
  GroundSeat seat = RandomGroundSeat(stage);
  for (const int side : {kLeft, kRight}) {
    stage.MoveTo(Of(kLegFlex, side), t - 0.03, 0.03, RadFromDeg(86.0) + stage.Final(kPelvisPitch));
    stage.MoveTo(Of(kKnee, side), t - 0.03, 0.03, RadFromDeg(110.0));
    stage.MoveTo(Of(kFree, side), t, 0.6, 1.0);
  }
  for (double g = t + 0.5; g < until - 0.5;) {
    if (stage.Chance(0.35) || g < t + 0.6) {
      if (g > t + 0.6) seat = RandomGroundSeat(stage);
      const double duration = stage.Beat(1.0);
      Lean(stage, g, duration, seat.pitch, seat.flex);
      MoveLeg(stage, kLeft, g, duration, OnGround(seat.left, seat.pitch));
      MoveLeg(stage, kRight, g, duration, OnGround(seat.right, seat.pitch));
      g += duration;
    }
    g = MakeGesture(stage, g, stage.Uniform(0.7, 2.0));
    if (stage.Chance(0.4)) stage.MoveTo(kTrunkTwist, g, 0.9, RadFromDeg(stage.Uniform(-30.0, 30.0)));
  }
  t = until + 0.1;
  stage.MoveTo(kTrunkTwist, t, 0.8, 0.0);
  if (stage.Chance(0.45)) t = LieDown(stage, t);
  for (const int side : {kLeft, kRight}) {
    MoveLeg(stage, side, t, 0.8,
            {RadFromDeg(86.0) + stage.Final(kPelvisPitch), RadFromDeg(4.0), RadFromDeg(108.0), RadFromDeg(5.0)});
    stage.MoveTo(Of(kFree, side), t + 0.4, 0.6, 0.0);
    stage.MoveTo(Of(kLegTwist, side), t, 0.8, 0.0);
    MoveArm(stage, side, t + 0.3, 1.0, AnglesOf(stage, ArmPose::kForward));
    MoveArm(stage, side, t + 1.9, 1.0, HangingArm(stage));
  }
  t += 1.1;
  const double up = stage.Beat(1.7);
  stage.MoveTo(kSurge, t, 0.75 * up, 0.0);
  stage.MoveTo(kPelvisZ, t + 0.1 * up, up, home);
  stage.Bump(kPelvisPitch, t, up, RadFromDeg(stage.Uniform(25.0, 45.0)));
  Lean(stage, t + 0.3 * up, 0.8 * up, 0.0, stage.style().trunk_lean);
  return t + 1.1 * up + 0.1;
}

}  // namespace

void PerformSit(Stage& stage) {
  StandNaturally(stage);
  PlaceFeet(stage, stage.style().stance_half_width * stage.Uniform(0.9, 1.6));
  LookAround(stage, 0.0, stage.seconds(), 2.5);
  double t = stage.Uniform(0.1, 0.8);
  bool first = true;
  while (t < stage.seconds()) {
    const bool chair = stage.Chance(0.68);
    t = chair ? SitOnChair(stage, t, first && stage.Chance(0.4)) : SitOnGround(stage, t);
    first = false;
    t += stage.Uniform(0.1, 0.8);
    if (stage.Chance(0.6)) t = WalkTo(stage, t, NearbySpot(stage, 1300.0, 800.0));
  }
}

}  // namespace canonpose
