#include "canonpose/motion/hierarchy_template.h"

namespace canonpose {

const std::array<TemplateJoint, kFittedJointCount>& HierarchyTemplate() {
  // Lumbar, Chest and the clavicles' inner ends are articulations between keypoints: where they lie is a convention.
  static constexpr std::array<TemplateJoint, kFittedJointCount> kJoints = {{
      {"Hip", "Hips", -1, "pelvis", true, false},
      {"Lumbar", "Spine", kFHip, "", true, false},
      {"Spine", "Spine1", kFLumbar, "spine", true, false},
      {"Chest", "Spine2", kFSpine, "", true, false},
      {"Thorax", "Neck", kFChest, "thorax", true, false},
      {"UpperNeck", "Head", kFThorax, "upperneck", true, false},
      {"Head", "HeadTop_End", kFSkull, "headtop", false, false},
      {"Nose", "", kFSkull, "nose", false, true},
      {"LEye", "", kFSkull, "leye", false, true},
      {"REye", "", kFSkull, "reye", false, true},
      {"LEar", "", kFSkull, "lear", false, true},
      {"REar", "", kFSkull, "rear", false, true},
      {"LClavicle", "LeftShoulder", kFChest, "", true, false},
      {"LShoulder", "LeftArm", kFLClavicle, "lshoulder", true, false},
      {"LElbow", "LeftForeArm", kFLShoulder, "lelbow", true, false},
      {"LWrist", "LeftHand", kFLElbow, "lwrist", false, false},
      {"LWrist_end", "LeftHand_end", kFLWrist, "", false, false},
      {"RClavicle", "RightShoulder", kFChest, "", true, false},
      {"RShoulder", "RightArm", kFRClavicle, "rshoulder", true, false},
      {"RElbow", "RightForeArm", kFRShoulder, "relbow", true, false},
      {"RWrist", "RightHand", kFRElbow, "rwrist", false, false},
      {"RWrist_end", "RightHand_end", kFRWrist, "", false, false},
      {"LHip", "LeftUpLeg", kFHip, "lhip", true, false},
      {"LKnee", "LeftLeg", kFLHip, "lknee", true, false},
      {"LFoot", "LeftFoot", kFLKnee, "lankle", true, false},
      {"LHeel", "", kFLAnkle, "lheel", false, true},
      {"LToes", "LeftToeBase", kFLAnkle, "", false, false},
      {"LBigToe", "LeftToe_End", kFLToes, "lbigtoe", false, false},
      {"LSmallToe", "", kFLToes, "lsmalltoe", false, true},
      {"RHip", "RightUpLeg", kFHip, "rhip", true, false},
      {"RKnee", "RightLeg", kFRHip, "rknee", true, false},
      {"RFoot", "RightFoot", kFRKnee, "rankle", true, false},
      {"RHeel", "", kFRAnkle, "rheel", false, true},
      {"RToes", "RightToeBase", kFRAnkle, "", false, false},
      {"RBigToe", "RightToe_End", kFRToes, "rbigtoe", false, false},
      {"RSmallToe", "", kFRToes, "rsmalltoe", false, true},
  }};
  return kJoints;
}

std::string NameOf(FittedJoint joint, JointNames names) {
  const TemplateJoint& row = HierarchyTemplate()[joint];
  return names == JointNames::kOurs ? row.ours : std::string("mixamorig:") + row.mixamo;
}

}  // namespace canonpose
