// Motion of an articulated body: a tree of rigid segments and the rotations of its joints over time.
//
// The world's frame here and in simulate/: millimetres, z up, ground near z = 0. Files with y up are converted when
// read.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace canonpose {

struct MotionJoint {
  std::string name;
  int parent = -1;            ///< index of an earlier joint; -1 for the first, the root
  Eigen::Vector3d offset_mm;  ///< from the parent joint, in the parent's frame; zero for the root
};

/// T frames of J joints. If all rotations are the identity, the body is in its rest pose, in the world's frame.
struct ArticulatedMotion {
  std::string name;     ///< of the clip: "01_01", "gait-3"
  std::string subject;  ///< clips of one subject share the joints' offsets
  double fps = 0.0;
  std::vector<MotionJoint> joints;                    ///< (J) parents before children
  std::vector<Eigen::Vector3d> root_position_mm;      ///< (T) in the world
  std::vector<Eigen::Quaterniond> parent_from_joint;  ///< (T, J); for the root, world_from_root

  [[nodiscard]] int frame_count() const { return static_cast<int>(root_position_mm.size()); }
  [[nodiscard]] int joint_count() const { return static_cast<int>(joints.size()); }
};

/// Forward kinematics of one frame: the joints' positions in the world, (J) mm, and their rotations world_from_joint,
/// (J).
void ForwardKinematics(const ArticulatedMotion& motion, int frame, std::vector<Eigen::Vector3d>& positions_mm,
                       std::vector<Eigen::Quaterniond>& world_from_joint);

/// The joints' positions in the rest pose, (J) mm, with the root at the origin.
std::vector<Eigen::Vector3d> RestPose(const ArticulatedMotion& motion);

}  // namespace canonpose
