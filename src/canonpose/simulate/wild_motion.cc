#include "canonpose/simulate/wild_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "canonpose/base/error.h"
#include "canonpose/simulate/people/body.h"
#include "canonpose/simulate/people/stage.h"
#include "canonpose/simulate/smooth_noise.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kNoiseSeconds = 0.6;
constexpr double kMaxKnee = RadFromDeg(148.0);
constexpr double kMaxElbow = RadFromDeg(145.0);

Quaterniond FromRotationVector(const Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-9) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

Quaterniond AboutY(double angle) { return {std::cos(angle / 2), 0, std::sin(angle / 2), 0}; }
Quaterniond AboutZ(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

Quaterniond& At(ArticulatedMotion& motion, int frame, int joint) {
  return motion.parent_from_joint[static_cast<std::size_t>(frame * motion.joint_count() + joint)];
}

bool Happens(double chance, Rng& rng) { return rng.Uniform() < chance; }

/// Three smooth random angles, a rotation vector.
class SmoothTurn {
 public:
  SmoothTurn(double deviation_rad, double fps, Rng& rng)
      : deviation_(deviation_rad),
        noises_{SmoothNoise(kNoiseSeconds, fps, rng), SmoothNoise(kNoiseSeconds, fps, rng),
                SmoothNoise(kNoiseSeconds, fps, rng)} {}
  Vector3d Next(Rng& rng) {
    const double x = noises_[0].Next(rng);
    const double y = noises_[1].Next(rng);
    const double z = noises_[2].Next(rng);
    return deviation_ * Vector3d(x, y, z);
  }

 private:
  double deviation_;
  std::array<SmoothNoise, 3> noises_;
};

/// The direction of a limb relative to hanging down, its rotation about itself and its bend; `outwards` is away from
/// the body.
struct LimbPose {
  double forward;
  double outwards;
  double twist;
  double bend;
};

LimbPose RaisedArm(Rng& rng) {
  const double raised = RadFromDeg(rng.Uniform(110.0, 180.0));
  const double plane = RadFromDeg(rng.Uniform(-20.0, 110.0));
  return {raised * std::cos(plane), raised * std::sin(plane), RadFromDeg(rng.Uniform(-60.0, 60.0)),
          Happens(0.5, rng) ? RadFromDeg(rng.Uniform(3.0, 40.0)) : RadFromDeg(rng.Uniform(20.0, 130.0))};
}

LimbPose AnyArm(Rng& rng) {
  const double raised = std::acos(rng.Uniform(-0.99, 0.99));
  const double plane = RadFromDeg(rng.Uniform(-45.0, 130.0));
  return {raised * std::cos(plane), raised * std::sin(plane), RadFromDeg(rng.Uniform(-75.0, 80.0)),
          Happens(0.4, rng) ? RadFromDeg(rng.Uniform(3.0, 40.0)) : RadFromDeg(rng.Uniform(20.0, 138.0))};
}

LimbPose AnyLeg(Rng& rng) {
  const double forward = RadFromDeg(rng.Uniform(-25.0, 115.0));
  // A lifted thigh usually comes with a bent knee.
  const double most = std::max(RadFromDeg(30.0), std::min(kMaxKnee, forward + RadFromDeg(60.0)));
  return {forward, RadFromDeg(rng.Uniform(-8.0, 45.0)), RadFromDeg(rng.Uniform(-25.0, 25.0)), rng.Uniform(0.0, most)};
}

/// One arm or leg of a clip.
class WildLimb {
 public:
  WildLimb(int upper_joint, int side, bool is_arm, double noise_rad, double hinge_noise_rad,
           std::optional<LimbPose> pose, double fps, Rng& rng)
      : upper_(upper_joint),
        side_(side),
        is_arm_(is_arm),
        hinge_noise_(hinge_noise_rad),
        pose_(pose),
        turn_(noise_rad, fps, rng),
        hinge_(kNoiseSeconds, fps, rng) {}

  void Apply(ArticulatedMotion& motion, int frame, Rng& rng) {
    Quaterniond& upper = At(motion, frame, upper_);
    Quaterniond& hinge = At(motion, frame, upper_ + 1);
    // Elbows bend about -y, knees about y.
    const double sign = is_arm_ ? -1.0 : 1.0;
    double bend = sign * 2.0 * std::atan2(hinge.y(), hinge.w());
    if (pose_) {
      const double outwards = SideSign(side_);
      upper = FromRotationVector({outwards * pose_->outwards, -pose_->forward, 0.0}) * AboutZ(-outwards * pose_->twist);
      bend = pose_->bend;
    }
    upper = FromRotationVector(turn_.Next(rng)) * upper;
    bend = std::clamp(bend + hinge_noise_ * hinge_.Next(rng), 0.0, is_arm_ ? kMaxElbow : kMaxKnee);
    hinge = AboutY(sign * bend);
  }

 private:
  int upper_;
  int side_;
  bool is_arm_;
  double hinge_noise_;
  std::optional<LimbPose> pose_;
  SmoothTurn turn_;
  SmoothNoise hinge_;
};

constexpr std::array<int, 4> kSpineJoints = {kBLumbar, kBSpine, kBNeck, kBUpperNeck};

void MoveSpine(const WildOptions& options, ArticulatedMotion& motion, Rng& rng) {
  const double noise = RadFromDeg(options.trunk_noise_deg) * rng.Uniform();
  // Far forward, or a little backward.
  const double bend = Happens(options.trunk_bent, rng) ? RadFromDeg(rng.Uniform(-20.0, 50.0)) : 0.0;
  std::vector<SmoothTurn> turns;
  for (std::size_t i = 0; i < kSpineJoints.size(); ++i) turns.emplace_back(noise, motion.fps, rng);
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (std::size_t i = 0; i < kSpineJoints.size(); ++i) {
      const bool is_trunk = kSpineJoints[i] == kBLumbar || kSpineJoints[i] == kBSpine;
      Quaterniond& joint = At(motion, f, kSpineJoints[i]);
      joint = FromRotationVector(turns[i].Next(rng) + Vector3d(0.0, is_trunk ? bend : 0.0, 0.0)) * joint;
    }
  }
}

void MoveLimbs(const WildOptions& options, ArticulatedMotion& motion, Rng& rng) {
  const double arm_noise = RadFromDeg(options.arm_noise_deg) * rng.Uniform();
  const double leg_noise = RadFromDeg(options.leg_noise_deg) * rng.Uniform();
  const double hinge_noise = RadFromDeg(options.hinge_noise_deg) * rng.Uniform();
  const bool raised = Happens(options.arms_raised, rng);
  const bool arms = Happens(options.arms_anywhere, rng);
  const bool legs = Happens(options.legs_anywhere, rng);
  std::vector<WildLimb> limbs;
  for (const int side : {kLeft, kRight}) {
    std::optional<LimbPose> arm;
    if (raised && Happens(0.85, rng)) arm = RaisedArm(rng);
    if (!raised && arms && Happens(0.8, rng)) arm = AnyArm(rng);
    std::optional<LimbPose> leg;
    if (legs && Happens(0.8, rng)) leg = AnyLeg(rng);
    limbs.emplace_back(ArmJoint(kBLShoulder, side), side, true, arm_noise, hinge_noise, arm, motion.fps, rng);
    limbs.emplace_back(LegJoint(kBLHip, side), side, false, leg_noise, hinge_noise, leg, motion.fps, rng);
  }
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (WildLimb& limb : limbs) limb.Apply(motion, f, rng);
  }
}

/// A rotation from the uniform distribution over all rotations (Shoemake 1992).
Quaterniond AnyRotation(Rng& rng) {
  Eigen::Vector4d q{rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()};
  q.normalize();
  return {q[0], q[1], q[2], q[3]};
}

void TiltBody(const WildOptions& options, ArticulatedMotion& motion, Rng& rng) {
  const double kind = rng.Uniform();
  const double degrees = kind < options.tumbled + options.leaning ? 25.0 : 5.0;
  const Vector3d lean{RadFromDeg(degrees) * rng.Normal(), RadFromDeg(degrees) * rng.Normal(), 0.0};
  const Quaterniond tilt = kind < options.tumbled ? AnyRotation(rng) : FromRotationVector(lean);
  for (int f = 0; f < motion.frame_count(); ++f) {
    Quaterniond& root = At(motion, f, 0);
    root = tilt * root;
  }
}

void RequireProcedural(const ArticulatedMotion& motion) {
  CANONPOSE_CHECK(motion.joint_count() == kBodyJointCount, "{} has {} joints instead of {}", motion.name,
                  motion.joint_count(), +kBodyJointCount);
}

}  // namespace

void MakeWild(ArticulatedMotion& motion, const WildOptions& options, Rng rng) {
  RequireProcedural(motion);
  MoveSpine(options, motion, rng);
  MoveLimbs(options, motion, rng);
  TiltBody(options, motion, rng);
}

void TakeUpperBody(const ArticulatedMotion& other, ArticulatedMotion& motion) {
  RequireProcedural(motion);
  RequireProcedural(other);
  CANONPOSE_CHECK(other.frame_count() > 0, "no frames in {}", other.name);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const int source = f % other.frame_count();
    for (int j = kBLumbar; j < kBLHip; ++j) {
      At(motion, f, j) = other.parent_from_joint[static_cast<std::size_t>(source * other.joint_count() + j)];
    }
  }
}

}  // namespace canonpose
