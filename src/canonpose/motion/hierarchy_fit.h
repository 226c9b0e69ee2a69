// A hierarchy with bones of constant length, as animation software wants it, fitted to joint positions over time.
#pragma once

#include <string>
#include <vector>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/motion/hierarchy_template.h"
#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// Frames first to last, both inclusive, in which a joint was not seen. Its rotation is interpolated there, or held
/// before it is first and after it is last seen.
struct UnseenFrames {
  std::string joint;  ///< of the hierarchy
  int first = 0;
  int last = 0;
};

struct HierarchyFit {
  ArticulatedMotion motion;
  std::vector<FittedJoint> roles;  ///< (J of the motion) what its joints are, whatever they are called
  std::vector<int> keypoints;      ///< (J) the joint of the poses that each was fitted to; -1: to none
  double stature_mm = 0.0;         ///< estimated from the lengths of limbs and trunk

  /// Distances of the hierarchy's joints from the poses', over all that are known, mm.
  double mean_error_mm = 0.0;
  double largest_error_mm = 0.0;
  std::string worst_joint;
  int worst_frame = 0;

  std::vector<UnseenFrames> unseen;     ///< of joints that were seen in other frames
  std::vector<std::string> never_seen;  ///< joints whose bones have the length of an average body, at rest
};

/// Fits the hierarchy of hierarchy_template.h to a person. Poses are in millimetres in a world with z up; they may have
/// gaps. Bones have the median length over all frames. Rotations follow limbs and trunk, and then bring all joints as
/// near as possible to the poses' (refine_positions.h). The twist of thighs and upper arms follows from the plane in
/// which knee and elbow bend, that of pelvis and chest from hips and shoulders, that of the head from its keypoints;
/// whatever is not shown stays at rest relative to its parent, and changes calmly (calm_rotations.h).
///
/// The rest pose is a T: arms sideways, palms down, looking towards -y, the left along +x. Feet without keypoints stay
/// at right angles to the shanks.
///
/// Throws Error(kBadInput) naming the person where the skeleton lacks hips or shoulders, or no limb was ever seen, and
/// std::logic_error where poses are not in millimetres.
HierarchyFit FitHierarchy(const PoseSequence& person, JointNames names);

}  // namespace canonpose
