#include "canonpose/simulate/people/pose_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A planted leg is not stretched beyond this fraction of its length (a knee flexion of about 9 degrees).
constexpr double kStretch = 0.9965;
constexpr double kMaxKnee = RadFromDeg(148.0);
constexpr double kMaxElbow = RadFromDeg(145.0);
constexpr double kMinElbow = RadFromDeg(3.0);

// max(x, 0), rounded within +-width.
double SoftPositive(double x, double width) {
  if (x <= -width) return 0.0;
  if (x >= width) return x;
  return (x + width) * (x + width) / (4.0 * width);
}
double SoftClamp(double x, double low, double high, double width) {
  return x + SoftPositive(low - x, width) - SoftPositive(x - high, width);
}

Quaterniond About(const Vector3d& axis, double angle) { return Quaterniond(Eigen::AngleAxisd(angle, axis)); }
Quaterniond AboutX(double angle) { return {std::cos(angle / 2), std::sin(angle / 2), 0, 0}; }
Quaterniond AboutY(double angle) { return {std::cos(angle / 2), 0, std::sin(angle / 2), 0}; }
Quaterniond AboutZ(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

Quaterniond FromRotationVector(const Vector3d& vector) {
  const double angle = vector.norm();
  return angle < 1e-9 ? Quaterniond::Identity() : About(vector / angle, angle);
}

// Forward flexion, bend to the left and twist to the left as one rotation.
Quaterniond Bend(double flex, double side, double twist) { return FromRotationVector({-side, flex, twist}); }

// The smallest rotation from straight down to a unit direction; only straight up is singular.
Quaterniond FromDown(const Vector3d& direction) { return Quaterniond::FromTwoVectors(Vector3d(0, 0, -1), direction); }

// Angle at the middle joint of two links whose ends are `distance` apart; 0 if they are straight.
double BendOf(double first, double second, double distance) {
  const double cosine = (first * first + second * second - distance * distance) / (2 * first * second);
  return kPi - std::acos(std::clamp(cosine, -1.0, 1.0));
}
double DistanceAt(double first, double second, double bend) {
  return std::sqrt(first * first + second * second + 2 * first * second * std::cos(bend));
}
// A distance that two links can span with a bend between a small one and `max_bend`.
double SpannableDistance(double first, double second, double distance, double max_bend) {
  const double length = first + second;
  return SoftClamp(distance, DistanceAt(first, second, max_bend), 0.998 * length, 0.014 * length);
}

// Frame whose z is opposite to `along` and whose x lies in the plane of `along` and `front`.
Quaterniond LimbFrame(const Vector3d& along, const Vector3d& front) {
  Matrix3d axes;
  axes.col(2) = -along;
  axes.col(1) = axes.col(2).cross(front).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return Quaterniond(axes);
}

struct Foot {
  Vector3d ankle;
  Quaterniond world_from_foot;
  double toe_bend;
};

class Solver {
 public:
  explicit Solver(const Stage& stage) : stage_(stage), body_(stage.body()) { tall_ = body_.stature; }

  // Everything except the arms' final rotations, which StoreArms() adds for all frames together.
  void Solve(int frame, double lowered, Vector3d& root, Quaterniond* local) {
    frame_ = static_cast<std::size_t>(frame);
    local_ = local;
    std::fill(local, local + kBodyJointCount, Quaterniond::Identity());
    SolvePelvis(lowered);
    root = pelvis_;
    for (const int side : {kLeft, kRight}) SolveLeg(side);
    SolveTrunk();
    for (const int side : {kLeft, kRight}) SolveArm(side);
  }

  // Avoiding obstacles is smoothed over time, so that an arm starts to swerve before it reaches them.
  void StoreArms(std::vector<Quaterniond>& local) {
    const int half = std::max(1, static_cast<int>(std::lround(0.10 * stage_.fps())));
    std::vector<double> kernel;
    for (int w = -half; w <= half; ++w) kernel.push_back(SmoothBump(0.5 + 0.5 * w / (half + 1.0)));
    const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
    for (const int side : {kLeft, kRight}) {
      const std::vector<ArmLine>& lines = arms_[Body::Index(side)];
      const int count = static_cast<int>(lines.size());
      for (int f = 0; f < count; ++f) {
        Vector3d upper = sum * lines[static_cast<std::size_t>(f)].upper;
        Vector3d fore = sum * lines[static_cast<std::size_t>(f)].fore;
        for (int w = -half; w <= half; ++w) {
          const ArmLine& near = lines[static_cast<std::size_t>(std::clamp(f + w, 0, count - 1))];
          upper += kernel[static_cast<std::size_t>(w + half)] * near.upper_evasion;
          fore += kernel[static_cast<std::size_t>(w + half)] * near.fore_evasion;
        }
        StoreArm(lines[static_cast<std::size_t>(f)], upper.normalized(), fore.normalized(),
                 &local[static_cast<std::size_t>(f * kBodyJointCount + ArmJoint(kBLClavicle, side))]);
      }
    }
  }

  // How far the pelvis must be lowered for the legs to reach the planted feet.
  double Deficit(int frame) {
    frame_ = static_cast<std::size_t>(frame);
    SolvePelvis(0.0);
    double deficit = 0.0;
    for (const int side : {kLeft, kRight}) {
      double weight = 1.0 - Free(side);
      if (!stage_.boots()) weight *= 1.0 - MinimumJerk(Get(Of(kFootLift, side)) / (0.03 * tall_));
      if (weight <= 0.0) continue;
      const Vector3d leg = HipOf(side) - PlantedFoot(side, 0.0).ankle;
      const double reach = kStretch * body_.leg(side);
      const double across = std::min(leg.head<2>().norm(), 0.9 * reach);
      const double over = leg.z() - std::sqrt(reach * reach - across * across);
      deficit = std::max(deficit, weight * SoftPositive(over, 4.0));
    }
    return deficit;
  }

 private:
  [[nodiscard]] double Get(int channel) const { return stage_[channel][frame_]; }
  [[nodiscard]] double Free(int side) const { return std::clamp(Get(Of(kFree, side)), 0.0, 1.0); }

  void SolvePelvis(double lowered) {
    const double yaw = Get(kPelvisYaw);
    world_from_pelvis_ = AboutZ(yaw) * AboutY(Get(kPelvisPitch)) * AboutX(-Get(kPelvisRoll));
    const double sway = Get(kSway);
    const double surge = Get(kSurge);
    pelvis_ = {Get(kPelvisX) + std::cos(yaw) * surge - std::sin(yaw) * sway,
               Get(kPelvisY) + std::sin(yaw) * surge + std::cos(yaw) * sway,
               body_.standing_hip_height() + Get(kPelvisZ) - lowered};
  }

  [[nodiscard]] Vector3d HipOf(int side) const {
    return pelvis_ + world_from_pelvis_ * Vector3d(0, SideSign(side) * body_.hip_width / 2, 0);
  }

  // A foot on the ground rolls over the ball when the heel is up, and over the heel when the toes are up.
  [[nodiscard]] Foot PlantedFoot(int side, double extra_pitch) const {
    const std::size_t i = Body::Index(side);
    if (stage_.boots()) return SkiBoot(side);
    const double pitch = Get(Of(kFootPitch, side)) + extra_pitch;
    constexpr double kWidth = RadFromDeg(4.0);
    const double heel_up = (pitch + std::sqrt(pitch * pitch + kWidth * kWidth) - kWidth) / 2;
    const double height = body_.ankle_height[i];
    const double lift = Get(Of(kFootLift, side));
    const Vector3d ball(body_.ball[i], 0, -height);
    const Vector3d heel(-body_.heel[i], 0, -height);
    const Quaterniond rising = AboutY(heel_up);
    const Quaterniond dipping = AboutY(pitch - heel_up);
    Vector3d ankle = ball - rising * ball;
    ankle = heel + dipping * (ankle - heel);
    const Quaterniond yaw = AboutZ(Get(Of(kFootYaw, side)));
    Foot foot;
    foot.ankle = Vector3d(Get(Of(kFootX, side)), Get(Of(kFootY, side)), lift + height) + yaw * ankle;
    foot.world_from_foot = yaw * AboutY(pitch) * AboutX(-Get(Of(kFootRoll, side)));
    const double grounded = std::exp(-std::max(lift, 0.0) / (0.025 * tall_));
    foot.toe_bend = std::min(heel_up * grounded, RadFromDeg(60.0));
    return foot;
  }

  // The channels give the position of the ankle itself.
  [[nodiscard]] Foot SkiBoot(int side) const {
    Foot foot;
    foot.ankle = {Get(Of(kFootX, side)), Get(Of(kFootY, side)), Get(Of(kFootLift, side))};
    foot.world_from_foot =
        AboutZ(Get(Of(kFootYaw, side))) * AboutY(Get(Of(kFootPitch, side))) * AboutX(-Get(Of(kFootRoll, side)));
    foot.toe_bend = 0.0;
    return foot;
  }

  // Direction from hip to ankle and distance of a free leg, in the world.
  [[nodiscard]] Vector3d FreeAnkle(int side) const {
    const std::size_t i = Body::Index(side);
    const double sign = SideSign(side);
    const double flex = SoftClamp(Get(Of(kLegFlex, side)), RadFromDeg(-40.0), RadFromDeg(125.0), RadFromDeg(8.0));
    const double abd = SoftClamp(Get(Of(kLegAbd, side)), RadFromDeg(-32.0), RadFromDeg(75.0), RadFromDeg(6.0));
    const double knee = SoftClamp(Get(Of(kKnee, side)), RadFromDeg(2.0), kMaxKnee, RadFromDeg(2.0));
    const Quaterniond swing = FromRotationVector({sign * abd, -flex, 0});
    const double distance = DistanceAt(body_.thigh[i], body_.shank[i], knee);
    return HipOf(side) + world_from_pelvis_ * (swing * Vector3d(0, 0, -distance));
  }

  // Thigh and shank for an ankle in the world; returns the world frame of the shank.
  Quaterniond BendLeg(int side, const Vector3d& ankle) {
    const std::size_t i = Body::Index(side);
    const double sign = SideSign(side);
    const Vector3d leg = world_from_pelvis_.conjugate() * (ankle - HipOf(side));
    const Vector3d along = leg.normalized();
    const double distance = SpannableDistance(body_.thigh[i], body_.shank[i], leg.norm(), kMaxKnee);
    double twist = Get(Of(kLegTwist, side));
    twist += (1.0 - Free(side)) * 0.75 * sign * (Get(Of(kFootYaw, side)) - Get(kPelvisYaw));
    twist = SoftClamp(twist, RadFromDeg(-42.0), RadFromDeg(62.0), RadFromDeg(8.0));
    const Vector3d front = FromDown(along) * (AboutZ(sign * twist) * Vector3d::UnitX());
    const double knee = BendOf(body_.thigh[i], body_.shank[i], distance);
    // Angle at the hip between the thigh and the line to the ankle.
    const double lean = std::atan2(body_.shank[i] * std::sin(knee), body_.thigh[i] + body_.shank[i] * std::cos(knee));
    const Vector3d thigh = std::cos(lean) * along + std::sin(lean) * front;
    const Vector3d thigh_front = std::cos(lean) * front - std::sin(lean) * along;
    const int hip_joint = LegJoint(kBLHip, side);
    local_[hip_joint] = LimbFrame(thigh, thigh_front);
    local_[hip_joint + 1] = AboutY(knee);
    return world_from_pelvis_ * local_[hip_joint] * local_[hip_joint + 1];
  }

  // How far a foot in the air would be below the ground.
  [[nodiscard]] double Sunken(int side, const Vector3d& ankle, const Quaterniond& world_from_foot) const {
    const std::size_t i = Body::Index(side);
    const double height = body_.ankle_height[i];
    const Vector3d tip = world_from_foot * Vector3d(body_.ball[i] + 0.034 * tall_, 0, -height);
    const Vector3d heel = world_from_foot * Vector3d(-body_.heel[i], 0, -0.9 * height);
    return SoftPositive(-(ankle.z() + std::min({tip.z(), heel.z(), -0.02 * tall_})), 20.0);
  }

  void SolveLeg(int side) {
    const double free = Free(side);
    const Vector3d free_ankle = free > 0.0 ? FreeAnkle(side) : Vector3d::Zero();
    Foot foot = PlantedFoot(side, 0.0);
    Quaterniond world_from_shank = BendLeg(side, (1.0 - free) * foot.ankle + free * free_ankle);
    if (!stage_.boots() && free < 1.0) {
      // An ankle bends up to about 32 degrees; then the heel comes off the ground.
      const Vector3d shank = foot.world_from_foot.conjugate() * (world_from_shank * Vector3d::UnitZ());
      const double tilt = std::atan2(shank.x(), std::max(shank.z(), 0.2));
      const double extra = (1.0 - free) * SoftPositive(tilt - RadFromDeg(30.0), RadFromDeg(8.0));
      if (extra > 0.0) {
        foot = PlantedFoot(side, extra);
        world_from_shank = BendLeg(side, (1.0 - free) * foot.ankle + free * free_ankle);
      }
    }
    const double plantar = SoftClamp(Get(Of(kAnkle, side)), RadFromDeg(-28.0), RadFromDeg(62.0), RadFromDeg(6.0));
    Quaterniond planted = world_from_shank.conjugate() * foot.world_from_foot;
    const int foot_joint = LegJoint(kBLFoot, side);
    if (free <= 0.0) {
      local_[foot_joint] = planted;
    } else {
      const Quaterniond in_air = planted.slerp(free, AboutY(plantar));
      const Vector3d ankle = (1.0 - free) * foot.ankle + free * free_ankle;
      const double sunken = MinimumJerk(free / 0.25) * Sunken(side, ankle, world_from_shank * in_air);
      if (sunken > 0.0) {
        world_from_shank = BendLeg(side, ankle + Vector3d(0, 0, sunken));
        planted = world_from_shank.conjugate() * foot.world_from_foot;
      }
      local_[foot_joint] = planted.slerp(free, AboutY(plantar));
    }
    local_[LegJoint(kBLToes, side)] = AboutY(-(1.0 - free) * foot.toe_bend);
  }

  void SolveTrunk() {
    const double flex = SoftClamp(Get(kTrunkFlex), RadFromDeg(-38.0), RadFromDeg(82.0), RadFromDeg(8.0));
    const double side = SoftClamp(Get(kTrunkSide), RadFromDeg(-42.0), RadFromDeg(42.0), RadFromDeg(6.0));
    const double twist = SoftClamp(Get(kTrunkTwist), RadFromDeg(-55.0), RadFromDeg(55.0), RadFromDeg(8.0));
    local_[kBHip] = world_from_pelvis_;
    local_[kBLumbar] = Bend(0.55 * flex, 0.5 * side, 0.3 * twist);
    local_[kBSpine] = Bend(0.45 * flex, 0.5 * side, 0.7 * twist);
    const double neck_flex = SoftClamp(Get(kNeckFlex), RadFromDeg(-55.0), RadFromDeg(52.0), RadFromDeg(8.0)) / 2;
    const double neck_side = SoftClamp(Get(kNeckSide), RadFromDeg(-38.0), RadFromDeg(38.0), RadFromDeg(6.0)) / 2;
    const double neck_twist = SoftClamp(Get(kNeckTwist), RadFromDeg(-76.0), RadFromDeg(76.0), RadFromDeg(8.0)) / 2;
    local_[kBNeck] = Bend(neck_flex, neck_side, neck_twist);
    local_[kBUpperNeck] = Bend(neck_flex, neck_side, neck_twist);
    PlaceTrunk();
  }

  // Positions of the parts of the body that arms may run into.
  void PlaceTrunk() {
    const auto& joints = body_.joints;
    const Quaterniond lumbar = world_from_pelvis_ * local_[kBLumbar];
    const Vector3d lumbar_at = pelvis_ + world_from_pelvis_ * joints[kBLumbar].offset_mm;
    const Vector3d spine_at = lumbar_at + lumbar * joints[kBSpine].offset_mm;
    world_from_thorax_ = lumbar * local_[kBSpine];
    thorax_ = spine_at + world_from_thorax_ * joints[kBThorax].offset_mm;
    const Vector3d neck = thorax_ + world_from_thorax_ * joints[kBNeck].offset_mm;
    const Quaterniond world_from_neck = world_from_thorax_ * local_[kBNeck];
    const Vector3d upper_neck = neck + world_from_neck * joints[kBUpperNeck].offset_mm;
    const Vector3d crown = upper_neck + world_from_neck * local_[kBUpperNeck] * joints[kBHead].offset_mm;
    const double across = body_.shoulder_width / 2;
    obstacles_[0] = {HipOf(kLeft), thorax_ + world_from_thorax_ * Vector3d(0, across, 0), 0.050 * tall_};
    obstacles_[1] = {HipOf(kRight), thorax_ + world_from_thorax_ * Vector3d(0, -across, 0), 0.050 * tall_};
    obstacles_[2] = {pelvis_, thorax_, 0.055 * tall_};
    obstacles_[3] = {upper_neck, crown, 0.050 * tall_};
    for (const int side : {kLeft, kRight}) {
      const Quaterniond world_from_thigh = world_from_pelvis_ * local_[LegJoint(kBLHip, side)];
      const Vector3d knee = HipOf(side) + world_from_thigh * Vector3d(0, 0, -body_.thigh[Body::Index(side)]);
      obstacles_[4 + Body::Index(side)] = {HipOf(side), knee, 0.042 * tall_};
    }
  }

  struct Obstacle {
    Vector3d from;
    Vector3d to;
    double radius;
  };

  // Smoothly moves a point of a limb of a certain thickness out of an obstacle.
  void PushOut(const Obstacle& obstacle, double thickness, Vector3d& point) const {
    const Vector3d axis = obstacle.to - obstacle.from;
    const double along = std::clamp((point - obstacle.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    const Vector3d away = point - (obstacle.from + along * axis);
    const double distance = away.norm();
    const double depth = SoftPositive(obstacle.radius + thickness - distance, 0.012 * tall_);
    // Smoothed at the axis, where the direction of avoidance changes sides.
    if (depth > 0.0) point += away * (depth / std::hypot(distance, 0.015 * tall_));
  }

  // Moves elbow and wrist out of trunk, head and thighs while keeping the arm's lengths.
  void Evade(int side, const Vector3d& shoulder, Vector3d& elbow, Vector3d& wrist) const {
    const std::size_t i = Body::Index(side);
    for (int round = 0; round < 4; ++round) {
      for (std::size_t o = 0; o < 4; ++o) PushOut(obstacles_[o], 0.010 * tall_, elbow);
      KeepAboveGround(elbow);
      elbow = shoulder + (elbow - shoulder).normalized() * body_.upper_arm[i];
      Vector3d middle = 0.5 * (elbow + wrist);
      const Vector3d before = middle;
      for (std::size_t o = 0; o < 4; ++o) PushOut(obstacles_[o], 0.010 * tall_, middle);
      wrist += 2.0 * (middle - before);
      for (const Obstacle& obstacle : obstacles_) PushOut(obstacle, 0.012 * tall_, wrist);
      KeepAboveGround(wrist);
      wrist = elbow + (wrist - elbow).normalized() * body_.forearm[i];
    }
  }

  void KeepAboveGround(Vector3d& point) const {
    if (!stage_.boots()) point.z() += SoftPositive(0.02 * tall_ - point.z(), 0.012 * tall_);
  }

  // Bends the elbow so that the wrist is at a place, and keeps the elbow on its side.
  void BringWrist(int side, const Vector3d& shoulder, const Vector3d& target, Vector3d& elbow, Vector3d& wrist) const {
    const std::size_t i = Body::Index(side);
    const double upper = body_.upper_arm[i];
    const double fore = body_.forearm[i];
    const Vector3d reach = target - shoulder;
    const Vector3d along = reach.normalized();
    const double distance = SpannableDistance(upper, fore, reach.norm(), kMaxElbow);
    // The elbow's previous direction, and a little down and out, which is rarely along a straight arm.
    const Vector3d pole = (elbow - shoulder) / upper + world_from_thorax_ * Vector3d(-0.5, 0.3 * SideSign(side), -0.5);
    const Vector3d out = (pole - pole.dot(along) * along).normalized();
    const double bend = BendOf(upper, fore, distance);
    const double lean = std::atan2(fore * std::sin(bend), upper + fore * std::cos(bend));
    elbow = shoulder + upper * (std::cos(lean) * along + std::sin(lean) * out);
    wrist = shoulder + distance * along;
  }

  Quaterniond ClavicleOf(int side, double flex, double abd) const {
    const double sign = SideSign(side);
    // The shoulder blade takes part in raising the arm.
    const double raised = SoftPositive(std::hypot(flex, abd) - RadFromDeg(45.0), RadFromDeg(15.0));
    const double up =
        SoftClamp(Get(Of(kShrug, side)) + 0.17 * raised, RadFromDeg(-8.0), RadFromDeg(34.0), RadFromDeg(4.0));
    const double ahead =
        SoftClamp(Get(Of(kProtract, side)) + 0.12 * flex, RadFromDeg(-18.0), RadFromDeg(24.0), RadFromDeg(4.0));
    return AboutZ(-sign * ahead) * AboutX(sign * up);
  }

  void SolveArm(int side) {
    const std::size_t i = Body::Index(side);
    const double sign = SideSign(side);
    double flex = SoftClamp(Get(Of(kShoulderFlex, side)), RadFromDeg(-62.0), RadFromDeg(176.0), RadFromDeg(8.0));
    double abd = SoftClamp(Get(Of(kShoulderAbd, side)), RadFromDeg(-48.0), RadFromDeg(176.0), RadFromDeg(6.0));
    const double angle = std::hypot(flex, abd);
    if (angle > RadFromDeg(160.0)) {
      const double shrink = SoftClamp(angle, 0.0, RadFromDeg(174.0), RadFromDeg(6.0)) / angle;
      flex *= shrink;
      abd *= shrink;
    }
    const double twist = SoftClamp(Get(Of(kShoulderTwist, side)), RadFromDeg(-92.0), RadFromDeg(98.0), RadFromDeg(8.0));
    const double bend = SoftClamp(Get(Of(kElbow, side)), kMinElbow, kMaxElbow - RadFromDeg(2.0), RadFromDeg(3.0));
    const Quaterniond clavicle = ClavicleOf(side, flex, abd);
    const int first = ArmJoint(kBLClavicle, side);
    const Vector3d shoulder =
        thorax_ + world_from_thorax_ * (body_.joints[static_cast<std::size_t>(first)].offset_mm +
                                        clavicle * body_.joints[static_cast<std::size_t>(first) + 1].offset_mm);
    const Quaterniond world_from_upper =
        world_from_thorax_ * FromRotationVector({sign * abd, -flex, 0}) * AboutZ(-sign * twist);
    Vector3d elbow = shoulder + world_from_upper * Vector3d(0, 0, -body_.upper_arm[i]);
    Vector3d wrist = elbow + world_from_upper * (AboutY(-bend) * Vector3d(0, 0, -body_.forearm[i]));
    const double weight = std::clamp(Get(Of(kHandWeight, side)), 0.0, 1.0);
    if (weight > 0.0) {
      const Vector3d hand(Get(Of(kHandX, side)), Get(Of(kHandY, side)), Get(Of(kHandZ, side)));
      Vector3d elbow_there = elbow;
      Vector3d wrist_there = wrist;
      BringWrist(side, shoulder, hand, elbow_there, wrist_there);
      // Interpolates between the two by the directions of upper arm and forearm.
      const Vector3d fore = (1.0 - weight) * (wrist - elbow) + weight * (wrist_there - elbow_there);
      elbow = shoulder + ((1.0 - weight) * elbow + weight * elbow_there - shoulder).normalized() * body_.upper_arm[i];
      wrist = elbow + fore.normalized() * body_.forearm[i];
    }
    ArmLine line{
        (elbow - shoulder).normalized(), (wrist - elbow).normalized(),        Vector3d::Zero(), Vector3d::Zero(),
        world_from_thorax_ * clavicle,   world_from_upper * Vector3d::UnitX()};
    Evade(side, shoulder, elbow, wrist);
    line.upper_evasion = Bounded((elbow - shoulder).normalized() - line.upper);
    line.fore_evasion = Bounded((wrist - elbow).normalized() - line.fore);
    arms_[i].push_back(line);
    local_[first] = clavicle;
  }

  // An arm in the world in one frame, and how it must avoid the trunk.
  struct ArmLine {
    Vector3d upper;
    Vector3d fore;
    Vector3d upper_evasion;
    Vector3d fore_evasion;
    Quaterniond world_from_clavicle;
    Vector3d front;  // of the elbow when the arm is straight
  };

  // Shorter than a unit vector, so that adding it to one never gives zero.
  static Vector3d Bounded(const Vector3d& evasion) { return evasion / std::sqrt(1.0 + evasion.squaredNorm() / 0.72); }

  // Rotations of shoulder and elbow from the directions of upper arm and forearm; `local` begins at the clavicle.
  static void StoreArm(const ArmLine& line, const Vector3d& upper, const Vector3d& fore, Quaterniond* local) {
    Vector3d front = fore - fore.dot(upper) * upper;
    const double bend = std::atan2(front.norm(), fore.dot(upper));
    // Neither a straight arm nor a completely folded one defines a plane.
    const double flat = SoftPositive(-fore.dot(upper) - 0.75, 0.1);
    front = bend < 1e-5 ? line.front : Vector3d(front + 2.5 * flat * line.front);
    local[1] = line.world_from_clavicle.conjugate() * LimbFrame(upper, front);
    local[2] = AboutY(-(bend - SoftPositive(bend - kMaxElbow + RadFromDeg(2.0), RadFromDeg(4.0))));
  }

  const Stage& stage_;
  const Body& body_;
  double tall_;
  std::size_t frame_ = 0;
  Quaterniond* local_ = nullptr;
  Vector3d pelvis_;
  Quaterniond world_from_pelvis_;
  Vector3d thorax_;
  Quaterniond world_from_thorax_;
  std::array<Obstacle, 6> obstacles_;
  std::array<std::vector<ArmLine>, 2> arms_;
};

}  // namespace

ArmAngles ReachWith(const Body& body, const Vector3d& wrist, const Vector3d& elbow_towards) {
  const double upper = body.upper_arm[kLeft] / body.arm(kLeft);
  const double fore = 1.0 - upper;
  const Vector3d along = wrist.normalized();
  const double distance = SpannableDistance(upper, fore, wrist.norm(), kMaxElbow);
  const Vector3d out = (elbow_towards - elbow_towards.dot(along) * along).normalized();
  const double bend = BendOf(upper, fore, distance);
  const double lean = std::atan2(fore * std::sin(bend), upper + fore * std::cos(bend));
  const Vector3d upper_direction = std::cos(lean) * along + std::sin(lean) * out;
  const Vector3d fore_direction = (distance * along - upper * upper_direction).normalized();
  const Quaterniond swing = FromDown(upper_direction);
  const Eigen::AngleAxisd turn(swing);
  const Vector3d vector = turn.angle() * turn.axis();
  const Vector3d fore_at_rest = swing.conjugate() * fore_direction;
  return {-vector.y(), vector.x(), -std::atan2(fore_at_rest.y(), fore_at_rest.x()), bend};
}

ArticulatedMotion PerformStage(const Stage& stage) {
  ArticulatedMotion motion;
  motion.fps = stage.fps();
  motion.joints = stage.body().joints;
  const auto frames = static_cast<std::size_t>(stage.frames());
  motion.root_position_mm.resize(frames);
  motion.parent_from_joint.resize(frames * kBodyJointCount);
  Solver solver(stage);
  std::vector<double> deficit(frames);
  for (std::size_t f = 0; f < frames; ++f) deficit[f] = solver.Deficit(static_cast<int>(f));
  const int half_window = std::max(1, static_cast<int>(std::lround(0.02 * stage.fps())));
  const std::vector<double> lowered = SmoothCover(deficit, half_window);
  for (std::size_t f = 0; f < frames; ++f) {
    solver.Solve(static_cast<int>(f), lowered[f], motion.root_position_mm[f],
                 &motion.parent_from_joint[f * kBodyJointCount]);
  }
  solver.StoreArms(motion.parent_from_joint);
  return motion;
}

}  // namespace canonpose
