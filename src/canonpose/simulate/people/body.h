// A person's build: the lengths of the segments and the tree of joints.
//
// The frame of the body, and of every joint in the rest pose: x forward, y left, z up. In the rest pose the body stands
// upright with hanging arms.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

enum Side : int { kLeft = 0, kRight = 1 };

/// +1 to the left, -1 to the right.
inline double SideSign(int side) { return side == kLeft ? 1.0 : -1.0; }

/// Joints of the procedural body, in the tree's order. Those without a landmark are articulations only. (The prefix is
/// kB, since landmarks have the short names.)
enum BodyJoint : int {
  kBHip,
  kBLumbar,
  kBSpine,
  kBThorax,
  kBNeck,
  kBUpperNeck,
  kBHead,
  kBNose,
  kBREye,
  kBLEye,
  kBREar,
  kBLEar,
  kBLClavicle,
  kBLShoulder,
  kBLElbow,
  kBLWrist,
  kBRClavicle,
  kBRShoulder,
  kBRElbow,
  kBRWrist,
  kBLHip,
  kBLKnee,
  kBLFoot,
  kBLHeel,
  kBLToes,
  kBLBigToe,
  kBLSmallToe,
  kBRHip,
  kBRKnee,
  kBRFoot,
  kBRHeel,
  kBRToes,
  kBRBigToe,
  kBRSmallToe,
  kBodyJointCount
};

/// The same joint of the limb on the other side. The left limbs begin with kBLClavicle and kBLHip.
inline int ArmJoint(int left_joint, int side) { return left_joint + (kBRClavicle - kBLClavicle) * side; }
inline int LegJoint(int left_joint, int side) { return left_joint + (kBRHip - kBLHip) * side; }

/// All lengths in mm; arrays are (left, right).
struct Body {
  double stature = 0.0;
  std::array<double, 2> thigh{};
  std::array<double, 2> shank{};
  std::array<double, 2> upper_arm{};
  std::array<double, 2> forearm{};
  std::array<double, 2> ankle_height{};  ///< of the ankle above the sole
  std::array<double, 2> ball{};          ///< of the foot, in front of the ankle; where the toes bend
  std::array<double, 2> heel{};          ///< behind the ankle
  double hip_width = 0.0;                ///< between the hips' centres
  double shoulder_width = 0.0;           ///< between the shoulders' centres
  double trunk = 0.0;                    ///< from the middle of the hips to the middle of the shoulders
  std::vector<MotionJoint> joints;       ///< (kBodyJointCount)

  [[nodiscard]] double leg(int side) const { return thigh[Index(side)] + shank[Index(side)]; }
  [[nodiscard]] double arm(int side) const { return upper_arm[Index(side)] + forearm[Index(side)]; }
  /// Height of the hips above the ground when standing straight, for the shorter leg.
  [[nodiscard]] double standing_hip_height() const;
  static std::size_t Index(int side) { return static_cast<std::size_t>(side); }
};

/// A random person: a woman or a man (or, one in ten, a child), with stature and proportions distributed as in the
/// population, and with about one percent difference between the sides of the body.
Body MakeBody(std::uint64_t subject_seed);

}  // namespace canonpose
