// The skeleton of the Acclaim format, as its .asf file describes it: y up, rotations about axes of each bone's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/motion/channels.h"

namespace canonpose {

/// A bone turns by C * M * C^-1 in its parent's frame: C from its axis, M the product of its channels' rotations, the
/// first letter of `order` applied first ("XYZ": Rz * Ry * Rx).
struct AcclaimBone {
  std::string name;
  int parent = -1;                                           ///< a bone; -1 for the root, which is bone 0
  Eigen::Vector3d end_mm = Eigen::Vector3d::Zero();          ///< from the bone's start, y up
  Eigen::Quaterniond axis = Eigen::Quaterniond::Identity();  ///< C, y up
  int order[3] = {0, 1, 2};                                  ///< axes in the order they are applied
  std::vector<Channel> channels;                             ///< in the order of the values in the .amc file
};

struct AcclaimSkeleton {
  std::string file;
  double unit_mm = 0.0;
  bool is_in_degrees = true;
  Eigen::Vector3d root_position_mm = Eigen::Vector3d::Zero();  ///< y up; the .amc's positions are added
  std::vector<AcclaimBone> bones;                              ///< the root first, parents before children
  /// The joints of a motion, one at the start of each bone, bones.size() of them in the same order, then the ends.
  std::vector<MotionJoint> joints;
};

/// Throws Error(kBadInput).
AcclaimSkeleton ReadAcclaimSkeleton(const std::filesystem::path& asf);

}  // namespace canonpose
