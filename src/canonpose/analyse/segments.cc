#include "canonpose/analyse/segments.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/base/median.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kUnknown = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

/// Unknown for a vector without length.
Vector3d Direction(const Vector3d& v) {
  const double norm = v.norm();
  return norm > 0.0 ? Vector3d(v / norm) : kUnknown;
}

/// The direction perpendicular to two others, unknown where these hardly differ.
Vector3d Perpendicular(const Vector3d& a, const Vector3d& b) {
  const Vector3d cross = Direction(a).cross(Direction(b));
  static const double kLeast = std::sin(RadFromDeg(kSmallestAngleDeg));
  return cross.norm() >= kLeast ? Vector3d(cross.normalized()) : kUnknown;
}

Matrix3d Columns(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  Matrix3d columns;
  columns << x, y, z;
  return columns;
}

/// A segment that is known by its long axis and the axis to the right at a right angle to it.
Matrix3d FromLongAxis(const Vector3d& up, const Vector3d& right) { return Columns(up.cross(right), up, right); }

LimbJoints FindLimbs(const Skeleton& skeleton, Side side) {
  const auto find = [&](const std::string& part) { return FindPart(skeleton, Suffix(side) + part).value_or(-1); };
  LimbJoints limbs;
  limbs.hip = find("hip");
  limbs.knee = find("knee");
  limbs.ankle = find("ankle");
  limbs.heel = find("heel");
  limbs.big_toe = find("bigtoe");
  if (limbs.big_toe < 0) limbs.big_toe = skeleton.Find(side == Side::kRight ? "right_toe" : "left_toe").value_or(-1);
  limbs.small_toe = find("smalltoe");
  limbs.shoulder = find("shoulder");
  limbs.elbow = find("elbow");
  limbs.wrist = find("wrist");
  return limbs;
}

/// x forward from the heel (the ankle where there is none) to the toes; y at right angles to the sole.
Matrix3d FootAt(const PoseSequence& person, const LimbJoints& limbs, Side side, int frame) {
  const Vector3d back = PositionOf(person, frame, limbs.heel >= 0 ? limbs.heel : limbs.ankle);
  const Vector3d big = PositionOf(person, frame, limbs.big_toe);
  if (limbs.small_toe < 0 || limbs.heel < 0) return Columns(Direction(big - back), kUnknown, kUnknown);
  const Vector3d small = PositionOf(person, frame, limbs.small_toe);
  const Vector3d forward = Direction((big + small) / 2.0 - back);
  const Vector3d up = Perpendicular(side == Side::kRight ? Vector3d(small - big) : Vector3d(big - small), forward);
  return Columns(forward, up, forward.cross(up));
}

LimbSegments LimbsAt(const PoseSequence& person, const LimbJoints& limbs, Side side, int frame) {
  const auto at = [&](int joint) { return PositionOf(person, frame, joint); };
  LimbSegments segments;
  const Vector3d thigh = Direction(at(limbs.hip) - at(limbs.knee));
  const Vector3d shank = Direction(at(limbs.knee) - at(limbs.ankle));
  // The knee bends backwards about the axis to the right, the elbow forwards.
  const Vector3d knee_axis = Perpendicular(shank, thigh);
  segments.thigh = FromLongAxis(thigh, knee_axis);
  segments.shank = FromLongAxis(shank, knee_axis);
  segments.foot = FootAt(person, limbs, side, frame);
  const Vector3d upper_arm = Direction(at(limbs.shoulder) - at(limbs.elbow));
  segments.forearm = Direction(at(limbs.elbow) - at(limbs.wrist));
  segments.upper_arm = FromLongAxis(upper_arm, Perpendicular(upper_arm, segments.forearm));
  return segments;
}

}  // namespace

BodyJoints FindBodyJoints(const Skeleton& skeleton) {
  BodyJoints joints;
  joints.right = FindLimbs(skeleton, Side::kRight);
  joints.left = FindLimbs(skeleton, Side::kLeft);
  joints.spine = FindPart(skeleton, "spine").value_or(-1);
  return joints;
}

BodyJoints FindBodyJoints(const PoseSequence& person) {
  BodyJoints joints = FindBodyJoints(person.skeleton());
  if (joints.spine < 0 || !joints.has_trunk()) return joints;
  std::vector<double> distances;  // from the mean, in lengths of the trunk
  for (int frame = 0; frame < person.frame_count(); ++frame) {
    const auto middle = [&](int a, int b) -> Vector3d {
      return (PositionOf(person, frame, a) + PositionOf(person, frame, b)) / 2.0;
    };
    const Vector3d hips = middle(joints.right.hip, joints.left.hip);
    const Vector3d shoulders = middle(joints.right.shoulder, joints.left.shoulder);
    const double distance = (PositionOf(person, frame, joints.spine) - (hips + shoulders) / 2.0).norm();
    const double relative = distance / (shoulders - hips).norm();
    if (std::isfinite(relative)) distances.push_back(relative);
  }
  static constexpr double kDerived = 0.02;
  if (!distances.empty() && Median(distances) < kDerived) joints.spine = -1;
  return joints;
}

Segments SegmentsAt(const PoseSequence& person, const BodyJoints& joints, int frame) {
  const auto at = [&](int joint) { return PositionOf(person, frame, joint); };
  const Vector3d hips = (at(joints.right.hip) + at(joints.left.hip)) / 2.0;
  const Vector3d shoulders = (at(joints.right.shoulder) + at(joints.left.shoulder)) / 2.0;
  const Vector3d waist = joints.spine >= 0 ? at(joints.spine) : hips;
  Segments segments;
  // The hips give the pelvis' axis exactly, the trunk's own line that of the trunk; the other axis is made to fit.
  const Vector3d right = Direction(at(joints.right.hip) - at(joints.left.hip));
  const Vector3d forward =
      Perpendicular(joints.spine >= 0 ? Vector3d(waist - hips) : Vector3d(shoulders - hips), right);
  segments.pelvis = Columns(forward, right.cross(forward), right);
  const Vector3d up = Direction(shoulders - waist);
  const Vector3d chest = Perpendicular(up, at(joints.right.shoulder) - at(joints.left.shoulder));
  segments.trunk = Columns(chest, up, chest.cross(up));
  segments.right = LimbsAt(person, joints.right, Side::kRight, frame);
  segments.left = LimbsAt(person, joints.left, Side::kLeft, frame);
  return segments;
}

Vector3d PositionOf(const PoseSequence& person, int frame, int joint) {
  if (joint < 0 || !person.IsKnown(frame, joint)) return kUnknown;
  return person.PoseAt(frame).row(joint).transpose().cast<double>();
}

double AngleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace canonpose
