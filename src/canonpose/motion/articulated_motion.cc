#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

void ForwardKinematics(const ArticulatedMotion& motion, int frame, std::vector<Eigen::Vector3d>& positions_mm,
                       std::vector<Eigen::Quaterniond>& world_from_joint) {
  const std::size_t count = motion.joints.size();
  positions_mm.resize(count);
  world_from_joint.resize(count);
  const Eigen::Quaterniond* local = &motion.parent_from_joint[static_cast<std::size_t>(frame) * count];
  for (std::size_t j = 0; j < count; ++j) {
    const MotionJoint& joint = motion.joints[j];
    if (joint.parent < 0) {
      positions_mm[j] = motion.root_position_mm[static_cast<std::size_t>(frame)];
      world_from_joint[j] = local[j];
      continue;
    }
    const auto parent = static_cast<std::size_t>(joint.parent);
    positions_mm[j] = positions_mm[parent] + world_from_joint[parent] * joint.offset_mm;
    world_from_joint[j] = world_from_joint[parent] * local[j];
  }
}

std::vector<Eigen::Vector3d> RestPose(const ArticulatedMotion& motion) {
  std::vector<Eigen::Vector3d> positions_mm(motion.joints.size(), Eigen::Vector3d::Zero());
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    const MotionJoint& joint = motion.joints[j];
    if (joint.parent >= 0) positions_mm[j] = positions_mm[static_cast<std::size_t>(joint.parent)] + joint.offset_mm;
  }
  return positions_mm;
}

}  // namespace canonpose
