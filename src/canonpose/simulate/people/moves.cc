#include "canonpose/simulate/people/moves.h"

#include <algorithm>
#include <cmath>

#include "canonpose/simulate/people/stepping.h"

namespace canonpose {
namespace {

double Wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

// The times of a jump's phases.
struct JumpTimes {
  double start;
  double bottom;
  double takeoff;
  double landing;
  double absorbed;
  double end;
  double velocity;  // of the takeoff
};

JumpTimes TimesOf(Stage& stage, double start, const Jump& jump) {
  JumpTimes times{};
  times.velocity = std::sqrt(2 * kGravityMmPerS2 * jump.height);
  const double flight = 2 * times.velocity / kGravityMmPerS2;
  // Pushing off takes as long as the distance needs at somewhat more than half the takeoff velocity.
  const double push = std::clamp(1.75 * (jump.crouch + stage.Tall(0.04)) / times.velocity, 0.12, 0.45);
  times.start = start;
  times.bottom = start + (jump.bounce ? 0.16 : stage.Beat(0.42));
  times.takeoff = times.bottom + push;
  times.landing = times.takeoff + flight;
  times.absorbed = times.landing + (jump.bounce ? 0.13 : 0.20);
  times.end = times.absorbed + (jump.bounce ? 0.18 : stage.Beat(0.5));
  return times;
}

void SwingArms(Stage& stage, const JumpTimes& times) {
  const double up = RadFromDeg(stage.Uniform(70.0, 160.0));
  for (const int side : {kLeft, kRight}) {
    const int flex = Of(kShoulderFlex, side);
    const double home = stage.Final(flex);
    stage.MoveTo(flex, times.start, times.bottom - times.start, RadFromDeg(stage.Uniform(-50.0, -25.0)));
    stage.MoveTo(flex, times.bottom - 0.03, times.takeoff - times.bottom + 0.1, up);
    stage.MoveTo(flex, times.landing - 0.12, times.end - times.landing + 0.1, home);
    stage.Bump(Of(kElbow, side), times.bottom, times.landing - times.bottom, RadFromDeg(stage.Uniform(5.0, 60.0)));
    stage.Bump(Of(kShoulderAbd, side), times.landing - 0.2, 0.7, RadFromDeg(stage.Uniform(5.0, 30.0)));
  }
}

void FlyLegs(Stage& stage, const JumpTimes& times, const Jump& jump) {
  const double flight = times.landing - times.takeoff;
  for (const int side : {kLeft, kRight}) {
    const LegPose& pose = side == kLeft ? jump.left_leg : jump.right_leg;
    // The free leg begins and ends like the planted one at these times: nearly straight under the pelvis, toes down.
    stage.MoveTo(Of(kLegFlex, side), times.takeoff - 0.40, 0.02, RadFromDeg(0.0));
    stage.MoveTo(Of(kLegAbd, side), times.takeoff - 0.40, 0.02, RadFromDeg(2.0));
    stage.MoveTo(Of(kKnee, side), times.takeoff - 0.40, 0.02, RadFromDeg(10.0));
    stage.MoveTo(Of(kAnkle, side), times.takeoff - 0.40, 0.02, RadFromDeg(40.0));
    stage.MoveTo(Of(kFree, side), times.takeoff - 0.09, 0.13, 1.0);
    MoveLeg(stage, side, times.takeoff - 0.05, 0.52 * flight + 0.05, pose);
    MoveLeg(stage, side, times.takeoff + 0.47 * flight, 0.52 * flight,
            {RadFromDeg(5.0), RadFromDeg(3.0), RadFromDeg(18.0), RadFromDeg(22.0)});
    stage.MoveTo(Of(kFree, side), times.landing - 0.07, 0.11, 0.0);
    stage.MoveTo(Of(kLegTwist, side), times.landing, 0.3, 0.0);
    stage.MoveTo(Of(kFootPitch, side), times.takeoff - 0.17, 0.17, RadFromDeg(48.0));
    stage.MoveTo(Of(kFootPitch, side), times.landing - 0.16, 0.1, RadFromDeg(18.0));
    stage.MoveTo(Of(kFootPitch, side), times.landing - 0.02, 0.14, 0.0);
  }
}

}  // namespace

Spot FinalSpot(const Stage& stage) { return {stage.Final(kPelvisX), stage.Final(kPelvisY), stage.Final(kPelvisYaw)}; }

double WalkTo(Stage& stage, double start, const Spot& spot) {
  const Spot from = FinalSpot(stage);
  const double turn = Wrapped(spot.yaw - from.yaw);
  const double distance = std::hypot(spot.x - from.x, spot.y - from.y);
  const double duration =
      std::max({0.5, distance / stage.Tall(0.36), std::abs(turn) / RadFromDeg(85.0)}) / stage.style().tempo;
  stage.MoveTo(kPelvisX, start, duration, spot.x);
  stage.MoveTo(kPelvisY, start, duration, spot.y);
  stage.MoveBy(kPelvisYaw, start, duration, turn);
  StepOptions options;
  options.half_width = stage.style().stance_half_width * stage.Uniform(0.85, 1.25);
  options.toe_out = stage.style().toe_out;
  options.heel_rise = RadFromDeg(28.0);
  options.cadence = stage.Uniform(1.35, 1.6);
  options.from = start + 0.05;
  options.to = start + duration + 2.0;
  double end = start + duration;
  for (const Step& step : PlanSteps(stage, options)) end = std::max(end, step.start + step.swing);
  return end + 0.1;
}

Spot NearbySpot(Stage& stage, double radius_mm, double step_mm) {
  const Spot from = FinalSpot(stage);
  const double direction = stage.Uniform(-kPi, kPi);
  const double distance = step_mm * stage.Uniform(0.3, 1.0);
  Spot spot{from.x + distance * std::cos(direction), from.y + distance * std::sin(direction), 0.0};
  const double out = std::hypot(spot.x, spot.y);
  if (out > radius_mm) {
    spot.x *= radius_mm / out;
    spot.y *= radius_mm / out;
  }
  spot.yaw = from.yaw + stage.Uniform(-1.0, 1.0) * stage.Uniform(0.0, kPi);
  return spot;
}

void StepBy(Stage& stage, int side, double start, double duration, double ahead, double left, double turn) {
  const double yaw = stage.Final(kPelvisYaw);
  stage.MoveBy(Of(kFootX, side), start, duration, std::cos(yaw) * ahead - std::sin(yaw) * left);
  stage.MoveBy(Of(kFootY, side), start, duration, std::sin(yaw) * ahead + std::cos(yaw) * left);
  stage.MoveBy(Of(kFootYaw, side), start, duration, turn);
  stage.Bump(Of(kFootLift, side), start, duration, stage.Tall(stage.Uniform(0.03, 0.07)));
  stage.Bump(Of(kFootPitch, side), start - 0.15, 0.65 * duration + 0.15, RadFromDeg(stage.Uniform(8.0, 24.0)));
}

void MovePelvis(Stage& stage, double start, double duration, double ahead, double left) {
  const double yaw = stage.Final(kPelvisYaw);
  stage.MoveBy(kPelvisX, start, duration, std::cos(yaw) * ahead - std::sin(yaw) * left);
  stage.MoveBy(kPelvisY, start, duration, std::sin(yaw) * ahead + std::cos(yaw) * left);
}

void ShiftWeight(Stage& stage, int side, double start, double duration, double share) {
  const Spot spot = FinalSpot(stage);
  const double dx = stage.Final(Of(kFootX, side)) - spot.x;
  const double dy = stage.Final(Of(kFootY, side)) - spot.y;
  const double ahead = std::cos(spot.yaw) * dx + std::sin(spot.yaw) * dy;
  const double left = -std::sin(spot.yaw) * dx + std::cos(spot.yaw) * dy;
  stage.MoveTo(kSway, start, duration, share * left);
  stage.MoveTo(kSurge, start, duration, share * (ahead + stage.Tall(0.02)));
  stage.MoveTo(kPelvisRoll, start, duration, share * SideSign(side) * RadFromDeg(stage.Uniform(0.0, 5.0)));
}

void MoveLeg(Stage& stage, int side, double start, double duration, const LegPose& pose) {
  stage.MoveTo(Of(kLegFlex, side), start, duration, pose.flex);
  stage.MoveTo(Of(kLegAbd, side), start, duration, pose.abd);
  stage.MoveTo(Of(kKnee, side), start, duration, pose.knee);
  stage.MoveTo(Of(kAnkle, side), start, duration, pose.ankle);
  stage.MoveTo(Of(kLegTwist, side), start, duration, pose.twist);
}

void LiftLeg(Stage& stage, int side, double start, double duration, const LegPose& pose) {
  ShiftWeight(stage, 1 - side, start - 0.25, 0.25 + 0.5 * duration, 0.9);
  // The free leg's angles begin near the standing leg's, before they have any weight.
  stage.MoveTo(Of(kLegFlex, side), start - 0.03, 0.03, RadFromDeg(2.0));
  stage.MoveTo(Of(kLegAbd, side), start - 0.03, 0.03, RadFromDeg(6.0));
  stage.MoveTo(Of(kKnee, side), start - 0.03, 0.03, RadFromDeg(25.0));
  stage.MoveTo(Of(kAnkle, side), start - 0.03, 0.03, RadFromDeg(5.0));
  stage.Bump(Of(kFootPitch, side), start - 0.1, 0.75 * duration, RadFromDeg(25.0));
  stage.Bump(Of(kFootLift, side), start, 0.9 * duration, stage.Tall(0.05));
  stage.MoveTo(Of(kFree, side), start, 0.65 * duration, 1.0);
  MoveLeg(stage, side, start, duration, pose);
}

void LowerLeg(Stage& stage, int side, double start, double duration) {
  stage.MoveTo(Of(kFree, side), start + 0.3 * duration, 0.7 * duration, 0.0);
  MoveLeg(stage, side, start, 0.9 * duration, {RadFromDeg(4.0), RadFromDeg(6.0), RadFromDeg(22.0), RadFromDeg(10.0)});
  stage.Bump(Of(kFootLift, side), start + 0.1 * duration, 0.9 * duration, stage.Tall(0.05));
  ShiftWeight(stage, 1 - side, start + 0.4 * duration, 0.6 * duration + 0.3, 0.0);
}

double DoJump(Stage& stage, double start, const Jump& jump) {
  const JumpTimes times = TimesOf(stage, start, jump);
  const double v = times.velocity;
  const double rise = stage.Tall(0.035);
  const double base = stage.Final(kPelvisZ);
  const double depth = jump.crouch;
  const double push = times.takeoff - times.bottom;
  const double absorb = times.absorbed - times.landing;
  const double landing_depth = std::min(0.42 * v * absorb, stage.Tall(0.22));
  // Heights are relative to how the body stood.
  stage.Quintic(kPelvisZ, {{times.start, 0.0},
                           {times.bottom, -depth, 0.0, 0.8 * v / push},
                           {times.takeoff, rise - base, v, -kGravityMmPerS2},
                           {times.landing, rise - base, -v, -kGravityMmPerS2},
                           {times.absorbed, -landing_depth, 0.0, 0.7 * v / absorb},
                           {times.end, 0.0}});
  const double bend = std::min(depth / stage.Tall(0.25), 1.2);
  stage.Bump(kPelvisPitch, times.start, times.takeoff - times.start + 0.05,
             bend * RadFromDeg(stage.Uniform(15.0, 38.0)));
  stage.Bump(kTrunkFlex, times.start, times.takeoff - times.start + 0.05, bend * RadFromDeg(stage.Uniform(0.0, 22.0)));
  stage.Bump(kSurge, times.start, times.takeoff - times.start, -0.25 * depth);
  const double softness = landing_depth / stage.Tall(0.25);
  stage.Bump(kPelvisPitch, times.landing - 0.08, times.end - times.landing,
             softness * RadFromDeg(stage.Uniform(12.0, 30.0)));
  stage.Bump(kSurge, times.landing, times.end - times.landing, -0.25 * landing_depth);
  MovePelvis(stage, times.bottom, times.landing + 0.12 - times.bottom, jump.ahead, jump.left);
  stage.MoveBy(kPelvisYaw, times.bottom + 0.4 * push, times.landing - times.bottom - 0.4 * push, jump.turn);
  const double flight = times.landing - times.takeoff;
  const Spot spot = FinalSpot(stage);
  for (const int side : {kLeft, kRight}) {
    // Both feet land at their previous positions relative to the pelvis, which may have turned.
    const double across = SideSign(side) * (stage.style().stance_half_width + 0.5 * jump.feet_apart);
    const double moved = 0.9 * flight;
    stage.MoveTo(Of(kFootX, side), times.takeoff + 0.05 * flight, moved, spot.x - std::sin(spot.yaw) * across);
    stage.MoveTo(Of(kFootY, side), times.takeoff + 0.05 * flight, moved, spot.y + std::cos(spot.yaw) * across);
    stage.MoveTo(Of(kFootYaw, side), times.takeoff + 0.05 * flight, moved,
                 spot.yaw + SideSign(side) * stage.style().toe_out);
  }
  FlyLegs(stage, times, jump);
  if (jump.arms_swing) SwingArms(stage, times);
  return times.end;
}

}  // namespace canonpose
