#include "canonpose/simulate/people/arm_poses.h"

#include <array>

namespace canonpose {
namespace {

using Eigen::Vector3d;

struct Entry {
  ArmPose pose;
  double wrist[3];  // of the left arm, from the shoulder, in arm lengths; as fractions of the stature for poses at the
                    // body
  double elbow[3];  // where the elbow points
  bool of_stature;  // the hand is at a point of the body, whatever the arm's length
};

constexpr std::array<Entry, 20> kEntries = {{
    {ArmPose::kHip, {0.030, -0.010, -0.225}, {-0.35, 1.0, -0.1}, true},
    {ArmPose::kPhone, {0.035, -0.020, 0.095}, {0.35, 0.75, -1.0}, true},
    {ArmPose::kBehindHead, {-0.055, -0.070, 0.110}, {0.05, 1.0, 0.35}, true},
    {ArmPose::kHeadTop, {0.015, -0.060, 0.200}, {0.10, 1.0, 0.1}, true},
    {ArmPose::kOverhead, {0.08, 0.06, 0.97}, {0.2, 1.0, 0.0}, false},
    {ArmPose::kSideways, {0.05, 0.98, 0.02}, {-0.5, 0.0, -0.8}, false},
    {ArmPose::kForward, {0.96, 0.02, 0.0}, {0.0, 0.6, -0.8}, false},
    {ArmPose::kUpDiagonal, {0.15, 0.65, 0.68}, {0.0, 0.3, -1.0}, false},
    {ArmPose::kGoalpost, {0.10, 0.52, 0.46}, {-0.1, 0.8, -0.9}, false},
    {ArmPose::kChest, {0.42, -0.12, -0.18}, {0.0, 1.0, -0.75}, false},
    {ArmPose::kCross, {0.125, -0.135, -0.110}, {0.1, 0.8, -0.9}, true},
    {ArmPose::kBelly, {0.135, -0.070, -0.190}, {-0.4, 0.9, -0.5}, true},
    {ArmPose::kBehindBack, {-0.085, -0.060, -0.235}, {-0.5, 1.0, 0.0}, true},
    {ArmPose::kGuard, {0.42, -0.10, 0.12}, {0.1, 0.45, -1.0}, false},
    {ArmPose::kPocket, {0.040, 0.015, -0.275}, {-1.0, 0.5, 0.0}, true},
    {ArmPose::kPointAhead, {0.93, -0.10, 0.12}, {0.0, 0.7, -0.7}, false},
    {ArmPose::kOtherShoulder, {0.110, -0.160, 0.0}, {0.4, 0.3, -1.0}, true},
    {ArmPose::kChin, {0.115, -0.090, 0.030}, {0.1, 0.4, -1.0}, true},
    {ArmPose::kLowForward, {0.62, 0.05, -0.70}, {-0.8, 0.5, -0.3}, false},
    {ArmPose::kCarry, {0.52, -0.02, -0.50}, {-1.0, 0.25, -0.4}, false},
}};

}  // namespace

ArmAngles HangingArm(Stage& stage) {
  const Style& style = stage.style();
  return {RadFromDeg(stage.Uniform(-6.0, 12.0)), style.arm_carry * stage.Uniform(0.7, 1.4),
          RadFromDeg(stage.Uniform(0.0, 40.0)), style.elbow_carry * stage.Uniform(0.5, 1.4)};
}

ArmAngles AnglesOf(Stage& stage, ArmPose pose) {
  for (const Entry& entry : kEntries) {
    if (entry.pose != pose) continue;
    const double arm = stage.body().arm(kLeft);
    const double scale = entry.of_stature ? stage.body().stature / arm : 1.0;
    const double freedom = entry.of_stature ? 0.015 : 0.06;
    const Vector3d loose(stage.Uniform(-1.0, 1.0), stage.Uniform(-1.0, 1.0), stage.Uniform(-1.0, 1.0));
    const Vector3d wrist = scale * Vector3d(entry.wrist) + freedom * loose;
    const Vector3d swivel(stage.Uniform(-0.2, 0.2), stage.Uniform(-0.2, 0.2), stage.Uniform(-0.2, 0.2));
    return ReachWith(stage.body(), wrist, Vector3d(entry.elbow) + swivel);
  }
  return HangingArm(stage);
}

ArmAngles RandomArm(Stage& stage) {
  ArmAngles angles{};
  // Directions are distributed over the sphere rather than over the angles, so few are straight up or down.
  const double raised = std::acos(stage.Uniform(-0.97, 0.98));
  const double plane = RadFromDeg(stage.Uniform(-42.0, 128.0));
  angles.flex = raised * std::cos(plane);
  angles.abd = raised * std::sin(plane);
  angles.twist = RadFromDeg(stage.Uniform(-75.0, 80.0));
  angles.elbow = stage.Chance(0.25) ? RadFromDeg(stage.Uniform(4.0, 35.0)) : RadFromDeg(stage.Uniform(30.0, 138.0));
  return angles;
}

void MoveArm(Stage& stage, int side, double start, double duration, const ArmAngles& angles) {
  stage.MoveTo(Of(kShoulderFlex, side), start, duration, angles.flex);
  stage.MoveTo(Of(kShoulderAbd, side), start, duration, angles.abd);
  stage.MoveTo(Of(kShoulderTwist, side), start, duration, angles.twist);
  stage.MoveTo(Of(kElbow, side), start, duration, angles.elbow);
}

}  // namespace canonpose
