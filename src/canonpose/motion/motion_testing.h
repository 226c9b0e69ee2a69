// For tests only: joint positions of a motion by name.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose::testing {

/// Positions of one frame by the joints' names, mm in the world.
inline std::map<std::string, Eigen::Vector3d> PositionsByName(const ArticulatedMotion& motion, int frame) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  ForwardKinematics(motion, frame, positions, rotations);
  std::map<std::string, Eigen::Vector3d> by_name;
  for (std::size_t j = 0; j < positions.size(); ++j) by_name[motion.joints[j].name] = positions[j];
  return by_name;
}

}  // namespace canonpose::testing
