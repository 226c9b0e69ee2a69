// From the joints of a motion, recognised by their names, to the landmarks of a body.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/motion/landmarks.h"

namespace canonpose {

/// The landmarks of a clip, found by the names of its joints: CMU's bones and those of their conversion to BVH, the
/// names of Mixamo, MotionBuilder, Biovision, SMPL, Blender and 3ds Max's Biped, with or without a prefix; or our own
/// where joints are named Thorax, LHip and LWrist, exactly as the landmarks are. Limbs, head and hips must have joints.
///
/// Hip is halfway between the hips. Spine, Thorax and UpperNeck lie on the line through the joints of the spine: Thorax
/// at the height of the shoulders, fixed to the chest; Spine at 47.5 % of that height above the hips, as in Human3.6M.
/// Landmarks of the head and the feet that have no joint are placed by anthropometry, as fractions of the stature
/// (measured by the legs) in the frame of their segment. This requires a rest pose that looks straight ahead with the
/// soles at right angles to the shanks. CMU's head bones end in the middle of a band of markers around the forehead;
/// the crown lies 3.5 % of the stature above.
///
/// `file` is for messages. Throws Error(kBadInput) that names the joints that were not found.
LandmarkTrack MakeLandmarkTrack(const ArticulatedMotion& motion, const std::string& file);

/// The stature of a body whose hips, knees and ankles are found by name, from the length of its legs (mm, or the unit
/// of the offsets); 0 where they are not found.
double StatureByLegs(const std::vector<MotionJoint>& joints);

/// The joints that show which way up a body is.
struct UprightJoints {
  int head = -1;
  int left_ankle = -1;
  int right_ankle = -1;
};

/// Nothing where one of them is not found by its name.
std::optional<UprightJoints> FindUprightJoints(const std::vector<MotionJoint>& joints);

}  // namespace canonpose
