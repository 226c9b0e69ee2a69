#include "canonpose/motion/up_axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "canonpose/base/log.h"
#include "canonpose/motion/landmark_mapping.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// People who bend, sit and lie for a while still have their head above their feet by this much in the mean.
constexpr double kUpright = 0.5;
/// Another direction is up only if the head is there nearly all the time,
constexpr double kClearly = 0.7;
/// or, where the rest pose says the same, by this much and by so much more than along the file's own up axis.
constexpr double kWithRestPose = 0.3;
constexpr double kMoreThanUp = 0.2;
constexpr double kClearRestPose = 0.8;
/// Feet that stand on the ground are within these fractions of the stature from 0, and from each other.
constexpr double kGroundLevel = 0.15;
constexpr double kGroundSpread = 0.2;
/// So many frames are enough to know.
constexpr int kFramesToLookAt = 500;

/// The axis of the world, with its sign, that is closest to a direction.
Vector3d NearestAxis(const Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  Vector3d nearest = Vector3d::Zero();
  nearest[axis] = direction[axis] < 0.0 ? -1.0 : 1.0;
  return nearest;
}

/// What the axis is called in the file, which was read with its y axis as z and its z axis as -y.
const char* NameInFile(const Vector3d& axis) {
  if (axis.x() != 0.0) return axis.x() > 0.0 ? "x" : "-x";
  if (axis.y() != 0.0) return axis.y() < 0.0 ? "z" : "-z";
  return axis.z() > 0.0 ? "y" : "-y";
}

/// The rotation that takes an axis of the world to z.
Quaterniond Raise(const Vector3d& axis) {
  if (axis.z() > 0.0) return Quaterniond::Identity();
  if (axis.z() < 0.0) return Quaterniond(0.0, 1.0, 0.0, 0.0);  // half a turn about x
  const double half = std::numbers::sqrt2 / 2.0;
  const Vector3d about = axis.cross(Vector3d::UnitZ());
  return {half, half * about.x(), half * about.y(), half * about.z()};
}

Vector3d FromAnklesToHead(const std::vector<Vector3d>& positions, const UprightJoints& joints) {
  const auto at = [&](int joint) { return positions[static_cast<std::size_t>(joint)]; };
  return at(joints.head) - 0.5 * (at(joints.left_ankle) + at(joints.right_ankle));
}

Vector3d MeanUp(const ArticulatedMotion& motion, const UprightJoints& joints) {
  const int step = std::max(1, motion.frame_count() / kFramesToLookAt);
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  std::vector<Vector3d> positions;
  std::vector<Quaterniond> rotations;
  for (int t = 0; t < motion.frame_count(); t += step) {
    ForwardKinematics(motion, t, positions, rotations);
    sum += FromAnklesToHead(positions, joints).normalized();
    ++count;
  }
  return sum / std::max(1, count);
}

/// Whether the lower foot stays near 0 along an axis.
bool FeetAreOnGround(const ArticulatedMotion& motion, const UprightJoints& joints, const Vector3d& axis,
                     double stature_mm) {
  const int step = std::max(1, motion.frame_count() / kFramesToLookAt);
  std::vector<double> heights;
  std::vector<Vector3d> positions;
  std::vector<Quaterniond> rotations;
  for (int t = 0; t < motion.frame_count(); t += step) {
    ForwardKinematics(motion, t, positions, rotations);
    heights.push_back(std::min(positions[static_cast<std::size_t>(joints.left_ankle)].dot(axis),
                               positions[static_cast<std::size_t>(joints.right_ankle)].dot(axis)));
  }
  std::sort(heights.begin(), heights.end());
  const auto at = [&](double share) { return heights[static_cast<std::size_t>(share * (heights.size() - 1.0))]; };
  return std::abs(at(0.5)) < kGroundLevel * stature_mm && at(0.9) - at(0.1) < kGroundSpread * stature_mm;
}

/// Turns the world by `world` and the rest pose by `rest`.
void Turn(ArticulatedMotion& motion, const Quaterniond& world, const Quaterniond& rest) {
  for (MotionJoint& joint : motion.joints) joint.offset_mm = rest * joint.offset_mm;
  for (Vector3d& position : motion.root_position_mm) position = world * position;
  const std::size_t joints = motion.joints.size();
  for (std::size_t i = 0; i < motion.parent_from_joint.size(); ++i) {
    Quaterniond& rotation = motion.parent_from_joint[i];
    rotation = (i % joints == 0 ? world : rest) * rotation * rest.conjugate();
  }
}

}  // namespace

void StandUpright(ArticulatedMotion& motion, const std::string& file) {
  const std::optional<UprightJoints> joints = FindUprightJoints(motion.joints);
  if (!joints || motion.frame_count() == 0) return;
  const Vector3d mean_up = MeanUp(motion, *joints);
  if (mean_up.z() >= kUpright) return;
  const Vector3d in_rest = FromAnklesToHead(RestPose(motion), *joints);
  const bool is_rest_clear = in_rest.cwiseAbs().maxCoeff() >= kClearRestPose * in_rest.norm() && in_rest.norm() > 0.0;
  const Vector3d rest_up = is_rest_clear ? NearestAxis(in_rest) : Vector3d(Vector3d::UnitZ());
  const double along_rest = mean_up.dot(rest_up);
  if (rest_up.z() <= 0.0 && along_rest >= kWithRestPose && along_rest >= mean_up.z() + kMoreThanUp) {
    LogInfo("{}: {} points up, as the rest pose and the motion show", file, NameInFile(rest_up));
    return Turn(motion, Raise(rest_up), Raise(rest_up));
  }
  const Vector3d up = NearestAxis(mean_up);
  if (mean_up.dot(up) < kClearly) return;
  if (up.z() < 0.0) {
    LogWarning("{}: with y up the person stands on the head all the time, so -y is taken to point up", file);
    return Turn(motion, Raise(up), Raise(rest_up));
  }
  if (FeetAreOnGround(motion, *joints, up, in_rest.norm())) {
    LogWarning("{}: with y up the person lies all the time, so {} is taken to point up, where the feet stay at 0", file,
               NameInFile(up));
    return Turn(motion, Raise(up), Raise(rest_up));
  }
  LogWarning("{}: the person lies all the time, head towards {}; if they stand, export the file with y up", file,
             NameInFile(up));
}

}  // namespace canonpose
