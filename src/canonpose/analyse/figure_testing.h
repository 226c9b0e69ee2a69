// For tests only: a figure whose joint angles are given.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"
#include "canonpose/motion/landmarks.h"
#include "canonpose/scene/pose_sequence.h"

namespace canonpose::testing {

/// Angles in degrees by name; those not given are 0.
using Posture = std::map<std::string, double>;

inline Eigen::Matrix3d About(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(RadFromDeg(degrees), axis).toRotationMatrix();
}

/// One pose, forward kinematics in axes x forward, y up, z right, then turned to a world with z up: mm, facing along x,
/// the middle of the hips at (0, 0, 1000).
class Figure {
 public:
  explicit Figure(Posture posture) : posture_(std::move(posture)) {
    const Eigen::Matrix3d pelvis =
        About(kUp, Get("pelvis_rotation")) * About(kForward, Get("pelvis_list")) * About(kRight, Get("pelvis_tilt"));
    const Eigen::Matrix3d trunk = pelvis * Turn("lumbar_extension", "lumbar_bending", "lumbar_rotation", 1.0);
    const Eigen::Vector3d hips(0, 1000, 0);
    const Eigen::Vector3d spine = hips + pelvis * Eigen::Vector3d(0, 200, 0);
    const Eigen::Vector3d shoulders = spine + trunk * Eigen::Vector3d(0, 300, 0);
    Put("Hip", hips);
    Put("Spine", spine);
    Put("Thorax", shoulders);
    for (const bool is_left : {false, true}) AddSide(is_left, pelvis, trunk, hips, shoulders);
  }

  [[nodiscard]] const std::map<std::string, Eigen::Vector3d>& joints() const { return joints_; }

 private:
  inline static const Eigen::Vector3d kForward = Eigen::Vector3d::UnitX();
  inline static const Eigen::Vector3d kUp = Eigen::Vector3d::UnitY();
  inline static const Eigen::Vector3d kRight = Eigen::Vector3d::UnitZ();

  double Get(const std::string& name) const {
    const auto found = posture_.find(name);
    return found == posture_.end() ? 0.0 : found->second;
  }
  Eigen::Matrix3d Turn(const std::string& flexion, const std::string& adduction, const std::string& rotation,
                       double side) const {
    return About(kRight, Get(flexion)) * About(kForward, side * Get(adduction)) * About(kUp, side * Get(rotation));
  }
  void Put(const std::string& joint, const Eigen::Vector3d& at) { joints_[joint] = {at.x(), -at.z(), at.y()}; }

  void AddSide(bool is_left, const Eigen::Matrix3d& pelvis, const Eigen::Matrix3d& trunk, const Eigen::Vector3d& hips,
               const Eigen::Vector3d& shoulders) {
    const std::string side = is_left ? "L" : "R";
    const std::string end = is_left ? "_l" : "_r";
    const double sign = is_left ? -1.0 : 1.0;
    const Eigen::Matrix3d thigh = pelvis * Turn("hip_flexion" + end, "hip_adduction" + end, "hip_rotation" + end, sign);
    const Eigen::Matrix3d shank = thigh * About(kRight, -Get("knee_angle" + end));
    const Eigen::Matrix3d foot =
        shank * Turn("ankle_angle" + end, "ankle_inversion" + end, "ankle_rotation" + end, sign);
    const Eigen::Vector3d hip = hips + pelvis * Eigen::Vector3d(0, 0, 100 * sign);
    const Eigen::Vector3d knee = hip + thigh * Eigen::Vector3d(0, -420, 0);
    const Eigen::Vector3d ankle = knee + shank * Eigen::Vector3d(0, -400, 0);
    const Eigen::Vector3d heel = ankle + foot * Eigen::Vector3d(-50, -60, 0);
    Put(side + "Hip", hip);
    Put(side + "Knee", knee);
    Put(side + "Foot", ankle);
    Put(side + "Heel", heel);
    Put(side + "BigToe", heel + foot * Eigen::Vector3d(250, 0, -40 * sign));
    Put(side + "SmallToe", heel + foot * Eigen::Vector3d(230, 0, 40 * sign));
    const Eigen::Matrix3d arm = trunk * Turn("arm_flex" + end, "arm_add" + end, "arm_rot" + end, sign);
    const Eigen::Matrix3d forearm = arm * About(kRight, Get("elbow_flex" + end));
    const Eigen::Vector3d shoulder = shoulders + trunk * Eigen::Vector3d(0, 0, 170 * sign);
    const Eigen::Vector3d elbow = shoulder + arm * Eigen::Vector3d(0, -300, 0);
    Put(side + "Shoulder", shoulder);
    Put(side + "Elbow", elbow);
    Put(side + "Wrist", elbow + forearm * Eigen::Vector3d(0, -250, 0));
  }

  Posture posture_;
  std::map<std::string, Eigen::Vector3d> joints_;
};

/// The postures of `skeleton`'s joints over time, 50 frames a second; joints that the figure lacks are missing.
inline PoseSequence Moving(const std::vector<Posture>& postures, const Skeleton& skeleton = LandmarkSkeleton()) {
  PoseSequence person(skeleton, static_cast<int>(postures.size()));
  person.unit = LengthUnit::kMillimetres;
  person.fps = 50.0;
  for (std::size_t t = 0; t < postures.size(); ++t) {
    const Figure figure(postures[t]);
    for (const auto& [name, at] : figure.joints()) {
      const std::optional<int> joint = skeleton.Find(name);
      if (joint) person.PoseAt(static_cast<int>(t)).row(*joint) = at.cast<float>();
    }
  }
  person.TrustKnownJoints();
  return person;
}

}  // namespace canonpose::testing
