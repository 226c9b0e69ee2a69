#include "canonpose/skeleton/joint_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using Names = std::vector<std::string>;

TEST(WithoutPrefix, TakesOffNamespacesAndCommonPrefixes) {
  EXPECT_THAT(WithoutPrefix({"mixamorig:Hips", "Armature|mixamorig:Head"}), ElementsAre("Hips", "Head"));
  EXPECT_THAT(WithoutPrefix({"Root", "Rig_Hips", "Rig_Head", "Rig_LeftArm", "Rig_RightArm"}),
              ElementsAre("Root", "Hips", "Head", "LeftArm", "RightArm"));
  EXPECT_THAT(WithoutPrefix({"mixamorigHips", "mixamorigHead", "mixamorigLeftArm", "mixamorigRightArm"}),
              ElementsAre("Hips", "Head", "LeftArm", "RightArm"));
  EXPECT_THAT(WithoutPrefix({"Bip01", "Bip01 Pelvis", "Bip01 L Thigh", "Bip01 R Thigh", "Bip01 Head"}),
              ElementsAre("Bip01", "Pelvis", "L Thigh", "R Thigh", "Head"));
}

TEST(WithoutPrefix, LeavesOtherNamesAlone) {
  for (const Names& names :
       {Names{"LHip", "LKnee", "LFoot", "LHeel"}, Names{"left_hip", "left_knee", "right_hip", "right_knee"},
        Names{"Spine", "Spine1", "Spine2", "Spine3"}, Names{"a:Hip", "b:Hip"}, Names{"Hips"}, Names{}}) {
    EXPECT_EQ(WithoutPrefix(names), names);
  }
}

}  // namespace
}  // namespace canonpose
