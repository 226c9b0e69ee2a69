// The segments of a body as coordinate systems, made from the joints of one pose.
//
// Axes as the International Society of Biomechanics recommends them (Wu et al. 2002, 2005), for both sides of the body:
// x forward, y up, z to the right, in the neutral posture: upright, arms hanging, palms forward. docs/analysis.md says
// how each is made and what keypoints cannot tell.
#pragma once

#include <array>

#include <Eigen/Core>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

enum class Side { kRight, kLeft };
inline constexpr std::array<Side, 2> kSides = {Side::kRight, Side::kLeft};
/// "r" or "l", the ending of names in OpenSim.
inline const char* Suffix(Side side) { return side == Side::kRight ? "r" : "l"; }

/// Two directions that are closer than this define no plane: an error in one of them tilts the plane almost six times
/// as far.
inline constexpr double kSmallestAngleDeg = 10.0;

/// Where the joints of one side are in the skeleton; -1 where it lacks them.
struct LimbJoints {
  int hip = -1;
  int knee = -1;
  int ankle = -1;
  int heel = -1;
  int big_toe = -1;
  int small_toe = -1;
  int shoulder = -1;
  int elbow = -1;
  int wrist = -1;
};

struct BodyJoints {
  LimbJoints right;
  LimbJoints left;
  int spine = -1;

  [[nodiscard]] const LimbJoints& Of(Side side) const { return side == Side::kRight ? right : left; }
  [[nodiscard]] bool has_hips() const { return right.hip >= 0 && left.hip >= 0; }
  [[nodiscard]] bool has_trunk() const { return has_hips() && right.shoulder >= 0 && left.shoulder >= 0; }
};

/// The joints of the skeleton, by the part of the body that they are.
BodyJoints FindBodyJoints(const Skeleton& skeleton);

/// The same without a spine that says nothing about how the trunk bends, since it was made as the mean of the hips and
/// shoulders: its median distance from that mean is less than 2 % of the trunk's length.
BodyJoints FindBodyJoints(const PoseSequence& person);

/// Rotations from a segment's axes to those of the poses: columns are its x, y and z. A column is NaN where it cannot
/// be told; of a straight limb only y is known.
struct LimbSegments {
  Eigen::Matrix3d thigh;
  Eigen::Matrix3d shank;
  Eigen::Matrix3d foot;  ///< x only, for want of a small toe
  Eigen::Matrix3d upper_arm;
  Eigen::Vector3d forearm;  ///< its y, from the wrist to the elbow
};

struct Segments {
  Eigen::Matrix3d pelvis;
  Eigen::Matrix3d trunk;
  LimbSegments right;
  LimbSegments left;

  [[nodiscard]] const LimbSegments& Of(Side side) const { return side == Side::kRight ? right : left; }
};

Segments SegmentsAt(const PoseSequence& person, const BodyJoints& joints, int frame);

/// The position of a joint; NaN where it is unknown, or `joint` is -1.
Eigen::Vector3d PositionOf(const PoseSequence& person, int frame, int joint);

/// The angle between two directions, radians; NaN where one is unknown.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace canonpose
