#include "canonpose/skeleton/mapping.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;

std::string Described(const char* source, const char* target, const char* joint) {
  const LayoutMapping mapping = MapLayout(*FindSkeleton(source), *FindSkeleton(target));
  return mapping.Describe(mapping.target.Find(joint).value());
}

TEST(MappingTest, EveryLayoutGivesBothSkeletons) {
  for (const Skeleton& source : BuiltinSkeletons()) {
    for (const char* target : {"h36m-17", "canonpose-16"}) {
      const LayoutMapping mapping = MapLayout(source, *FindSkeleton(target));
      ASSERT_EQ(mapping.joints.size(), FindSkeleton(target)->joints.size());
      for (const JointSource& joint : mapping.joints) EXPECT_FALSE(joint.sources.empty());
    }
  }
}

TEST(MappingTest, FollowsTheConventionOfTheField) {
  EXPECT_EQ(Described("body_25", "h36m-17", "Hip"), "MidHip");
  EXPECT_EQ(Described("halpe-26", "h36m-17", "Hip"), "Hip");
  for (const char* layout : {"body_25b", "coco-18", "coco-17"}) {
    EXPECT_EQ(Described(layout, "h36m-17", "Hip"), "Hip = mean(LHip, RHip)");
  }
  for (const char* layout : {"body_25", "body_25b", "coco-18", "coco-17", "halpe-26"}) {
    EXPECT_EQ(Described(layout, "h36m-17", "Thorax"), "Thorax = mean(LShoulder, RShoulder)");
    EXPECT_EQ(Described(layout, "canonpose-16", "neck"), "neck = mean(LShoulder, RShoulder)");
    EXPECT_EQ(Described(layout, "h36m-17", "Spine"), "Spine = mean(LHip, RHip, LShoulder, RShoulder)");
    EXPECT_EQ(Described(layout, "h36m-17", "Nose"), "Nose");
    EXPECT_EQ(Described(layout, "h36m-17", "LFoot"), "LAnkle");
    EXPECT_EQ(Described(layout, "canonpose-16", "rhand"), "RWrist");
  }
  EXPECT_EQ(Described("body_25b", "h36m-17", "Head"), "HeadTop");
  EXPECT_EQ(Described("halpe-26", "h36m-17", "Head"), "Head");
  EXPECT_EQ(Described("coco-17", "h36m-17", "Head"), "Head = mean(LEye, REye)");
  EXPECT_EQ(Described("h36m-17", "canonpose-16", "neck"), "Thorax");
  EXPECT_EQ(Described("canonpose-16", "h36m-17", "Hip"), "root");
}

TEST(MappingTest, APrefixDoesNotMatter) {
  for (const Skeleton& source : BuiltinSkeletons()) {
    for (const char* prefix : {"mixamorig:", "Character1_", "Armature|"}) {
      Skeleton prefixed = source;
      for (std::string& joint : prefixed.joints) joint.insert(0, prefix);
      const LayoutMapping plain = MapLayout(source, *FindSkeleton("h36m-17"));
      const LayoutMapping mapping = MapLayout(prefixed, *FindSkeleton("h36m-17"));
      const LayoutMapping back = MapAvailableJoints(*FindSkeleton("h36m-17"), prefixed);
      const LayoutMapping plain_back = MapAvailableJoints(*FindSkeleton("h36m-17"), source);
      for (std::size_t j = 0; j < plain.joints.size(); ++j)
        EXPECT_EQ(mapping.joints[j].sources, plain.joints[j].sources);
      for (std::size_t j = 0; j < back.joints.size(); ++j)
        EXPECT_EQ(back.joints[j].sources, plain_back.joints[j].sources);
      EXPECT_EQ(FindPart(prefixed, "lknee"), FindPart(source, "lknee"));
    }
  }
}

TEST(MappingTest, ASideMayStandBehindTheJoint) {
  const Skeleton layout{"", {"Knee_Left", "knee right", "hand.L", "hand.R", "EAR_LEFT"}, {-1, 0, 0, 0, 0}, 0, {}};
  EXPECT_EQ(FindPart(layout, "lknee"), 0);
  EXPECT_EQ(FindPart(layout, "rknee"), 1);
  EXPECT_EQ(FindPart(layout, "lwrist"), 2);
  EXPECT_EQ(FindPart(layout, "rwrist"), 3);
  EXPECT_EQ(FindPart(layout, "lear"), 4);
}

TEST(MappingTest, MidEarsWhereThereAreNoEyes) {
  Skeleton source = *FindSkeleton("coco-17");
  source.joints[1] = "Whisker1";
  source.joints[2] = "Whisker2";
  const LayoutMapping mapping = MapLayout(source, *FindSkeleton("h36m-17"));
  EXPECT_EQ(mapping.Describe(10), "Head = mean(LEar, REar)");
}

TEST(MappingTest, LongNamesAndCentreOfTheHead) {
  Skeleton source;
  source.joints = {"head_top",   "neck",       "right_shoulder", "right_elbow", "right_wrist", "left_shoulder",
                   "left_elbow", "left_wrist", "right_hip",      "right_knee",  "right_ankle", "left_hip",
                   "left_knee",  "left_ankle", "pelvis",         "spine",       "head"};
  const LayoutMapping mapping = MapLayout(source, *FindSkeleton("h36m-17"));
  EXPECT_EQ(mapping.Describe(9), "head");
  EXPECT_EQ(mapping.Describe(10), "head_top");
  EXPECT_EQ(mapping.Describe(7), "spine");
  EXPECT_EQ(mapping.Describe(16), "right_wrist");
}

TEST(MappingTest, MixamosShoulderIsTheCollarBone) {
  Skeleton source;
  source.joints = {"mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine1",     "mixamorig:Spine2",
                   "mixamorig:Neck", "mixamorig:Head",  "mixamorig:HeadTop_End"};
  for (const std::string side : {"Left", "Right"}) {
    for (const char* part : {"Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase"}) {
      source.joints.push_back("mixamorig:" + side + part);
    }
  }
  const LayoutMapping mapping = MapLayout(source, *FindSkeleton("h36m-17"));
  const auto made_from = [&](const char* joint) { return mapping.Describe(mapping.target.Find(joint).value()); };
  for (const auto& [joint, name] : {std::pair("LShoulder", "LeftArm"),
                                    {"LElbow", "LeftForeArm"},
                                    {"LWrist", "LeftHand"},
                                    {"RShoulder", "RightArm"},
                                    {"RElbow", "RightForeArm"},
                                    {"RWrist", "RightHand"},
                                    {"LHip", "LeftUpLeg"},
                                    {"LKnee", "LeftLeg"},
                                    {"LFoot", "LeftFoot"},
                                    {"RHip", "RightUpLeg"},
                                    {"RKnee", "RightLeg"},
                                    {"RFoot", "RightFoot"},
                                    {"Head", "HeadTop_End"}}) {
    EXPECT_EQ(made_from(joint), std::string("mixamorig:") + name) << joint;
  }
  EXPECT_EQ(made_from("Thorax"), "Thorax = mean(mixamorig:LeftArm, mixamorig:RightArm)");
}

TEST(MappingTest, ALayoutOntoItselfIsACopy) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    const LayoutMapping mapping = MapLayout(skeleton, skeleton);
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      EXPECT_EQ(mapping.joints[static_cast<std::size_t>(j)].sources, std::vector<int>{j}) << skeleton.name;
    }
  }
  const Skeleton dog{"", {"Withers", "Tail"}, {-1, 0}, 0, {0, 1}};
  EXPECT_EQ(MapLayout(dog, dog).DescribeAll(), (std::vector<std::string>{"Withers", "Tail"}));
}

TEST(MappingTest, MirroringTheSourceMirrorsTheTarget) {
  for (const Skeleton& source : BuiltinSkeletons()) {
    const Skeleton& target = *FindSkeleton("h36m-17");
    const LayoutMapping mapping = MapLayout(source, target);
    for (std::size_t t = 0; t < mapping.joints.size(); ++t) {
      std::vector<int> mirrored;
      for (const int s : mapping.joints[t].sources) mirrored.push_back(source.mirror[static_cast<std::size_t>(s)]);
      EXPECT_THAT(mirrored, ::testing::UnorderedElementsAreArray(
                                mapping.joints[static_cast<std::size_t>(target.mirror[t])].sources));
    }
  }
}

TEST(MappingTest, NamesTheJointsThatCannotBeMade) {
  const Skeleton arm{"arm", {"LShoulder", "LElbow", "LWrist"}, {-1, 0, 1}, 0, {0, 1, 2}};
  const std::string message = testing::ErrorOf(ErrorKind::kBadInput, [&] { MapLayout(arm, *FindSkeleton("h36m-17")); });
  EXPECT_THAT(message, HasSubstr("layout arm"));
  EXPECT_THAT(message, HasSubstr("RKnee"));
  EXPECT_THAT(message, HasSubstr("Thorax"));
}

TEST(MappingTest, AMissingSourceMakesTheTargetMissing) {
  const Skeleton source{"", {"LHip", "RHip"}, {-1, 0}, 0, {1, 0}};
  const Skeleton target{"", {"Hip", "LHip", "RHip"}, {-1, 0, 0}, 0, {0, 2, 1}};
  const LayoutMapping mapping = MapLayout(source, target);
  EXPECT_EQ(mapping.derived(), (std::vector<int>{1, 0, 0}));
  float keypoints[] = {10.0F, 20.0F, 30.0F, 60.0F};
  float confidence[] = {0.9F, 0.5F};
  float mapped[6];
  float mapped_confidence[3];
  ApplyMapping(mapping, keypoints, confidence, mapped, mapped_confidence);
  EXPECT_FLOAT_EQ(mapped[0], 20.0F);
  EXPECT_FLOAT_EQ(mapped[1], 40.0F);
  EXPECT_FLOAT_EQ(mapped_confidence[0], 0.5F);
  EXPECT_FLOAT_EQ(mapped_confidence[1], 0.9F);

  keypoints[2] = NAN;
  ApplyMapping(mapping, keypoints, confidence, mapped, mapped_confidence);
  EXPECT_TRUE(std::isnan(mapped[0]));
  EXPECT_EQ(mapped_confidence[0], 0.0F);
  EXPECT_FLOAT_EQ(mapped[2], 10.0F);
  EXPECT_TRUE(std::isnan(mapped[4]));
}

TEST(MappingTest, FindsPartsWhateverTheirNames) {
  EXPECT_EQ(FindPart(*FindSkeleton("h36m-17"), "rankle"), 3);
  EXPECT_EQ(FindPart(*FindSkeleton("canonpose-16"), "lwrist"), 15);
  EXPECT_EQ(FindPart(*FindSkeleton("body_25"), "pelvis"), 8);
  EXPECT_FALSE(FindPart(*FindSkeleton("coco-17"), "pelvis").has_value());
}

}  // namespace
}  // namespace canonpose
