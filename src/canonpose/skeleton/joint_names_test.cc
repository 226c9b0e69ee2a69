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

TEST(SidePartners, FollowFromNames) {
  EXPECT_THAT(SidePartners({"nose", "left ear", "right ear"}), ElementsAre(0, 2, 1));
  EXPECT_THAT(SidePartners({"LeftEar", "RightEar", "tail"}), ElementsAre(1, 0, 2));
  EXPECT_THAT(SidePartners({"forelegR1", "forelegL1"}), ElementsAre(1, 0));
  EXPECT_THAT(SidePartners({"ear_L", "ear_R", "L_hip", "R_hip", "LKnee", "RKnee", "paw.l", "paw.r"}),
              ElementsAre(1, 0, 3, 2, 5, 4, 7, 6));
  EXPECT_THAT(SidePartners({"lankle", "rankle", "EAR_LEFT", "EAR_RIGHT", "kneeL", "kneeR"}),
              ElementsAre(1, 0, 3, 2, 5, 4));
}

TEST(SidePartners, AreTheJointItselfWithoutOne) {
  EXPECT_THAT(SidePartners({"leg", "rear", "lip", "left paw", "root"}), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(SidePartners({}), ElementsAre());
  // A mouse's "rear" must not become the partner of another mouse's "lear".
  EXPECT_THAT(SidePartners({"rear_left", "rear_right", "lear_x"}), ElementsAre(1, 0, 2));
}

}  // namespace
}  // namespace canonpose
