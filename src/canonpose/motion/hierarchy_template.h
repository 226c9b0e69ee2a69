// The joints of the hierarchy that is fitted to a person, and what each is called.
#pragma once

#include <array>
#include <string>

#include "canonpose/base/enum_names.h"

namespace canonpose {

enum class JointNames { kOurs, kMixamo };

template <>
inline constexpr std::array kEnumNames<JointNames>{
    EnumName{JointNames::kOurs, "ours", "the names of our skeletons: LHip, LKnee, LFoot"},
    EnumName{JointNames::kMixamo, "mixamo",
             "Mixamo's, which game engines and Blender's add-ons map: mixamorig:LeftUpLeg"}};

/// Parents come before their children; a limb's joints follow each other. Left limbs begin with kFLClavicle and kFLHip.
enum FittedJoint : int {
  kFHip,
  kFLumbar,
  kFSpine,
  kFChest,
  kFThorax,
  kFSkull,
  kFCrown,
  kFNose,
  kFLEye,
  kFREye,
  kFLEar,
  kFREar,
  kFLClavicle,
  kFLShoulder,
  kFLElbow,
  kFLWrist,
  kFLHandEnd,
  kFRClavicle,
  kFRShoulder,
  kFRElbow,
  kFRWrist,
  kFRHandEnd,
  kFLHip,
  kFLKnee,
  kFLAnkle,
  kFLHeel,
  kFLToes,
  kFLBigToe,
  kFLSmallToe,
  kFRHip,
  kFRKnee,
  kFRAnkle,
  kFRHeel,
  kFRToes,
  kFRBigToe,
  kFRSmallToe,
  kFittedJointCount
};

struct TemplateJoint {
  const char* ours;
  const char* mixamo;  ///< "" where Mixamo's rigs have no such joint
  int parent;
  const char* part;   ///< of FindPart(); "" where no skeleton of ours has a keypoint for it
  bool rotates;       ///< relative to its parent, as far as keypoints show it
  bool only_if_seen;  ///< it is left out for skeletons that lack its keypoint
};

/// (kFittedJointCount)
const std::array<TemplateJoint, kFittedJointCount>& HierarchyTemplate();

/// "mixamorig:LeftUpLeg", or "LHip".
std::string NameOf(FittedJoint joint, JointNames names);

}  // namespace canonpose
