// The skeleton of the Acclaim format as described by its .asf file: y up, rotations about each bone's own axes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/motion/channels.h"

namespace canonpose {

/// A bone rotates by C * M * C^-1 in its parent's frame, where C comes from its axis and M is the product of its
/// channels' rotations, the first letter of `order` applied first ("XYZ": Rz * Ry * Rx).
struct AcclaimBone {
  std::string name;
  int parent = -1;                                           ///< index of a bone; -1 for the root, which is bone 0
  Eigen::Vector3d end_mm = Eigen::Vector3d::Zero();          ///< from the bone's start, y up
  Eigen::Quaterniond axis = Eigen::Quaterniond::Identity();  ///< C, y up
  int order[3] = {0, 1, 2};                                  ///< axes in the order in which they are applied
  std::vector<Channel> channels;                             ///< in the order of the values in the .amc file
};

struct AcclaimSkeleton {
  std::string file;
  double unit_mm = 0.0;
  bool is_in_degrees = true;
  Eigen::Vector3d root_position_mm = Eigen::Vector3d::Zero();  ///< y up; the positions in the .amc file are added to it
  std::vector<AcclaimBone> bones;                              ///< the root first, parents before children
  /// The joints of a motion: first one at the start of each bone, in the same order, then the ends of the last bones.
  std::vector<MotionJoint> joints;
};

/// Reads an .asf file. Throws Error(kBadInput).
AcclaimSkeleton ReadAcclaimSkeleton(const std::filesystem::path& asf);

}  // namespace canonpose
