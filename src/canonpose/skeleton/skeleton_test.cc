#include "canonpose/skeleton/skeleton.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

Skeleton Stick() { return {"stick", {"Hip", "LKnee", "RKnee"}, {-1, 0, 0}, 0, {0, 2, 1}}; }

TEST(SkeletonTest, BuiltinsHoldTheInvariants) {
  const std::vector<std::pair<std::string, int>> expected = {{"h36m-17", 17},  {"canonpose-16", 16}, {"body_25", 25},
                                                             {"body_25b", 25}, {"coco-18", 18},      {"coco-17", 17},
                                                             {"halpe-26", 26}, {"coco-23", 23}};
  ASSERT_EQ(BuiltinSkeletons().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Skeleton& skeleton = BuiltinSkeletons()[i];
    EXPECT_EQ(skeleton.name, expected[i].first);
    EXPECT_EQ(skeleton.joint_count(), expected[i].second);
    EXPECT_EQ(skeleton.Problem(), "") << skeleton.name;
  }
  EXPECT_EQ(BuiltinSkeletonNames(), "h36m-17, canonpose-16, body_25, body_25b, coco-18, coco-17, halpe-26, coco-23");
}

TEST(SkeletonTest, SidesMirrorEachOtherAndTheMidlineItself) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const std::string& joint = skeleton.joints[static_cast<std::size_t>(j)];
      const std::string& partner =
          skeleton.joints[static_cast<std::size_t>(skeleton.mirror[static_cast<std::size_t>(j)])];
      const bool sided = (joint[0] == 'L' || joint[0] == 'R' || joint[0] == 'l' || joint[0] == 'r') && joint != "root";
      EXPECT_EQ(sided, joint != partner) << skeleton.name << " " << joint;
      EXPECT_EQ(joint.substr(1), partner.substr(1)) << skeleton.name;
    }
  }
}

TEST(SkeletonTest, PlacesOfJointsAreThoseOfTheFormats) {
  const auto expect = [](const char* layout, const char* joint, int index) {
    EXPECT_EQ(FindSkeleton(layout)->Find(joint), index) << layout << " " << joint;
  };
  expect("h36m-17", "Nose", 9);
  expect("h36m-17", "RWrist", 16);
  expect("canonpose-16", "root", 6);
  expect("canonpose-16", "lhand", 15);
  expect("body_25", "MidHip", 8);
  expect("body_25", "RHeel", 24);
  expect("body_25b", "HeadTop", 18);
  expect("body_25b", "RHip", 12);
  expect("coco-18", "LEar", 17);
  expect("coco-17", "RAnkle", 16);
  expect("halpe-26", "Hip", 19);
  expect("halpe-26", "RBigToe", 21);
  expect("coco-23", "LHeel", 19);
  expect("coco-23", "RBigToe", 20);
  EXPECT_EQ(FindSkeleton("canonpose-16")->root, 6);
  EXPECT_EQ(FindSkeleton("body_25")->root, 8);
}

TEST(SkeletonTest, NamesAreFoundWhateverTheirCase) {
  EXPECT_EQ(FindSkeleton("BODY-25B")->name, "body_25b");
  EXPECT_EQ(FindSkeleton("H36M_17")->name, "h36m-17");
  EXPECT_EQ(FindSkeleton("body_26"), nullptr);
  EXPECT_EQ(FindSkeleton("h36m-17")->Find("lknee"), 5);
  EXPECT_FALSE(FindSkeleton("h36m-17")->Find("tail").has_value());
}

TEST(SkeletonTest, ProblemNamesWhatIsWrong) {
  EXPECT_EQ(Stick().Problem(), "");
  Skeleton skeleton = Stick();
  skeleton.joints.clear();
  EXPECT_EQ(skeleton.Problem(), "there are no joints");
  skeleton = Stick();
  skeleton.parents.pop_back();
  EXPECT_EQ(skeleton.Problem(), "2 parents for 3 joints");
  skeleton = Stick();
  skeleton.mirror = {0, 2, 2};
  EXPECT_EQ(skeleton.Problem(), "mirror entry 2 of LKnee does not lead back");
  skeleton = Stick();
  skeleton.mirror = {0, 2, 7};
  EXPECT_EQ(skeleton.Problem(), "mirror entry 2 of LKnee does not lead back");
  skeleton = Stick();
  skeleton.joints[2] = "lknee";
  EXPECT_EQ(skeleton.Problem(), "there are two joints named lknee");
  skeleton = Stick();
  skeleton.parents = {-1, 2, 1};
  EXPECT_EQ(skeleton.Problem(), "the parents of LKnee do not lead to the root");
  skeleton = Stick();
  skeleton.parents[1] = -1;
  EXPECT_EQ(skeleton.Problem(), "LKnee has no parent but is not the root");
  skeleton = Stick();
  skeleton.root = 3;
  EXPECT_EQ(skeleton.Problem(), "root 3 is not one of 3 joints");
}

TEST(SkeletonTest, SameJointsMeansOrderAndRoot) {
  Skeleton other = Stick();
  other.name = "";
  EXPECT_TRUE(Stick().SameJoints(other));
  other.root = 1;
  EXPECT_FALSE(Stick().SameJoints(other));
  other = Stick();
  std::swap(other.joints[1], other.joints[2]);
  EXPECT_FALSE(Stick().SameJoints(other));
}

TEST(SkeletonTest, ASubsetHangsFromTheAncestorsThatAreThere) {
  const Skeleton& whole = *FindSkeleton("h36m-17");
  // Without the thorax, the left knee and the legs' ends.
  std::vector<int> joints;
  for (int j = 0; j < whole.joint_count(); ++j) {
    const std::string& name = whole.joints[static_cast<std::size_t>(j)];
    if (name != "Thorax" && name != "LKnee" && name != "LFoot" && name != "RFoot") joints.push_back(j);
  }
  const Skeleton part = Subset(whole, joints);
  EXPECT_EQ(part.Problem(), "");
  EXPECT_EQ(part.joint_count(), whole.joint_count() - 4);
  const auto at = [&](const char* name) { return static_cast<std::size_t>(*part.Find(name)); };
  EXPECT_EQ(part.joints[static_cast<std::size_t>(part.root)], "Hip");
  EXPECT_EQ(part.parents[at("LShoulder")], *part.Find("Spine"));
  EXPECT_EQ(part.mirror[at("RKnee")], *part.Find("RKnee"));
  EXPECT_EQ(part.mirror[at("LWrist")], *part.Find("RWrist"));
  EXPECT_THROW((void)Subset(whole, {1, 2}), std::logic_error);
}

}  // namespace
}  // namespace canonpose
