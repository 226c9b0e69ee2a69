#include "canonpose/motion/hierarchy_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/motion/hierarchy_testing.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/motion_files.h"
#include "canonpose/motion/motion_testing.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::Animate;
using testing::ErrorOf;
using testing::PosesOf;
using testing::Shared;
using testing::TPoseHierarchy;

const Skeleton& SkeletonNamed(const std::string& name) { return *FindSkeleton(name); }

/// The largest change of any joint's rotation from one frame to the next, and where that is.
std::pair<double, std::string> LargestStep(const ArticulatedMotion& motion) {
  std::pair<double, std::string> largest = {0.0, ""};
  const std::size_t joints = motion.joints.size();
  for (std::size_t i = joints; i < motion.parent_from_joint.size(); ++i) {
    const double step = DegFromRad(motion.parent_from_joint[i].angularDistance(motion.parent_from_joint[i - joints]));
    if (step > largest.first)
      largest = {step, motion.joints[i % joints].name + " in frame " + std::to_string(i / joints)};
  }
  return largest;
}

std::map<std::string, Vector3d> RestByName(const ArticulatedMotion& motion) {
  const std::vector<Vector3d> rest = RestPose(motion);
  std::map<std::string, Vector3d> by_name;
  for (std::size_t j = 0; j < rest.size(); ++j) by_name[motion.joints[j].name] = rest[j];
  return by_name;
}

TEST(FitHierarchy, RecoversAHierarchyFromItsJointsForEverySkeleton) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
    Animate(200, 0.0, truth);
    const HierarchyFit fit = FitHierarchy(PosesOf(truth, skeleton), JointNames::kOurs);
    EXPECT_LT(fit.mean_error_mm, 0.2) << skeleton.name;
    EXPECT_LT(fit.largest_error_mm, 1.0) << skeleton.name << " " << fit.worst_joint << " " << fit.worst_frame;
    ASSERT_EQ(fit.motion.joints.size(), truth.motion.joints.size()) << skeleton.name;
    for (std::size_t j = 0; j < fit.motion.joints.size(); ++j) {
      EXPECT_NEAR(fit.motion.joints[j].offset_mm.norm(), truth.motion.joints[j].offset_mm.norm(), 1.5)
          << skeleton.name << " " << fit.motion.joints[j].name;
    }
    const auto [step, joint] = LargestStep(fit.motion);
    EXPECT_LT(step, 6.0) << skeleton.name << " " << joint;
    EXPECT_TRUE(fit.unseen.empty());
    EXPECT_NEAR(fit.stature_mm, 1750.0, 60.0) << skeleton.name;
  }
}

// Rotations, not only positions: the twist of limbs that bend is known.
TEST(FitHierarchy, RecoversRotationsWhereLimbsBend) {
  const Skeleton& skeleton = SkeletonNamed("body_25");
  HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
  Animate(150, 0.5, truth);
  const HierarchyFit fit = FitHierarchy(PosesOf(truth, skeleton), JointNames::kOurs);
  const std::size_t joints = fit.motion.joints.size();
  for (std::size_t i = 0; i < fit.motion.parent_from_joint.size(); ++i) {
    const double off = DegFromRad(fit.motion.parent_from_joint[i].angularDistance(truth.motion.parent_from_joint[i]));
    // Along the spine and the neck, positions leave open which joint turns.
    const FittedJoint role = fit.roles[i % joints];
    if (role > kFHip && role <= kFSkull) continue;
    EXPECT_LT(off, 5.0) << fit.motion.joints[i % joints].name << " in frame " << i / joints;
  }
}

TEST(FitHierarchy, StaysCalmUnderNoise) {
  const Skeleton& skeleton = SkeletonNamed("h36m-17");
  HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
  Animate(300, 0.0, truth);
  PoseSequence noisy = PosesOf(truth, skeleton);
  Rng rng(11);
  for (float& value : noisy.positions()) value += static_cast<float>(5.0 * rng.Normal());
  const HierarchyFit fit = FitHierarchy(noisy, JointNames::kOurs);
  EXPECT_LT(fit.mean_error_mm, 9.0);  // the noise itself is 8 mm long in the mean
  const auto [step, joint] = LargestStep(fit.motion);
  EXPECT_LT(step, 25.0) << joint;
}

TEST(FitHierarchy, StraightLimbsDoNotSpin) {
  const Skeleton& skeleton = SkeletonNamed("h36m-17");
  HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
  Animate(200, 0.0, truth);
  // Knees and elbows are straight: only noise bends them.
  for (std::size_t i = 0; i < truth.motion.parent_from_joint.size(); ++i) {
    const FittedJoint role = truth.roles[i % truth.roles.size()];
    if (role == kFLKnee || role == kFRKnee || role == kFLElbow || role == kFRElbow)
      truth.motion.parent_from_joint[i] = Quaterniond::Identity();
  }
  PoseSequence noisy = PosesOf(truth, skeleton);
  Rng rng(12);
  for (float& value : noisy.positions()) value += static_cast<float>(3.0 * rng.Normal());
  const HierarchyFit fit = FitHierarchy(noisy, JointNames::kOurs);
  const auto [step, joint] = LargestStep(fit.motion);
  EXPECT_LT(step, 15.0) << joint;
}

TEST(FitHierarchy, RestsInATThatLooksForward) {
  HierarchyFit truth = TPoseHierarchy(SkeletonNamed("body_25b"), JointNames::kOurs);
  Animate(50, 1.0, truth);
  const HierarchyFit fit = FitHierarchy(PosesOf(truth, SkeletonNamed("body_25b")), JointNames::kOurs);
  std::map<std::string, Vector3d> rest = RestByName(fit.motion);
  for (const auto& [left, right] : {std::pair("LWrist", "RWrist"), {"LElbow", "RElbow"}}) {
    EXPECT_GT(rest[left].x(), 450.0);
    EXPECT_LT(rest[right].x(), -450.0);
    EXPECT_NEAR(rest[left].z(), rest["LShoulder"].z(), 1.0);
    EXPECT_NEAR(rest[left].y(), rest["LShoulder"].y(), 1.0);
  }
  EXPECT_GT(rest["Head"].z(), rest["LShoulder"].z() + 200.0);
  EXPECT_LT(rest["Nose"].y(), rest["Head"].y() - 50.0);
  EXPECT_LT(rest["LBigToe"].y(), rest["LHeel"].y() - 200.0);
  EXPECT_NEAR(rest["LBigToe"].z(), rest["LHeel"].z(), 20.0);
  EXPECT_GT(rest["LSmallToe"].x(), rest["LBigToe"].x() + 30.0);
  EXPECT_LT(rest["RSmallToe"].x(), rest["RBigToe"].x() - 30.0);
  EXPECT_LT(rest["LFoot"].z(), -800.0);
  EXPECT_TRUE(rest["Hip"].isZero());
}

TEST(FitHierarchy, MixamosNamesAndOursAreBothReadBack) {
  const Skeleton& skeleton = SkeletonNamed("halpe-26");
  for (const JointNames names : {JointNames::kOurs, JointNames::kMixamo}) {
    HierarchyFit truth = TPoseHierarchy(skeleton, names);
    Animate(5, 0.0, truth);
    const HierarchyFit fit = FitHierarchy(PosesOf(truth, skeleton), names);
    EXPECT_LT(fit.largest_error_mm, 2.0);
    EXPECT_EQ(fit.motion.joints[0].name, names == JointNames::kOurs ? "Hip" : "mixamorig:Hips");
    const LandmarkTrack track = MakeLandmarkTrack(fit.motion, "fit");
    const std::map<std::string, Vector3d> joints = testing::PositionsByName(fit.motion, 3);
    EXPECT_LT((track.At(3, kLWrist) - joints.at(NameOf(kFLWrist, names))).norm(), 1e-6);
    EXPECT_LT((track.At(3, kRKnee) - joints.at(NameOf(kFRKnee, names))).norm(), 1e-6);
    EXPECT_LT((track.At(3, kLShoulder) - joints.at(NameOf(kFLShoulder, names))).norm(), 1e-6);
  }
}

TEST(FitHierarchy, GapsAreInterpolatedHeldAndReported) {
  const Skeleton& skeleton = SkeletonNamed("h36m-17");
  HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
  Animate(100, 0.0, truth);
  PoseSequence person = PosesOf(truth, skeleton);
  const auto hide = [&](const char* joint, int first, int last) {
    for (int t = first; t <= last; ++t) person.PoseAt(t).row(*skeleton.Find(joint)).setConstant(std::nanf(""));
  };
  for (const std::string& joint : skeleton.joints) hide(joint.c_str(), 40, 45);  // everything
  hide("LWrist", 60, 69);
  hide("RFoot", 0, 9);
  hide("LElbow", 80, 80);
  for (const char* joint : {"Head", "Nose"}) hide(joint, 0, 99);
  const HierarchyFit fit = FitHierarchy(person, JointNames::kOurs);
  EXPECT_LT(fit.largest_error_mm, 1.0) << fit.worst_joint << " " << fit.worst_frame;
  const auto [step, joint] = LargestStep(fit.motion);
  EXPECT_LT(step, 8.0) << joint;
  std::vector<std::string> unseen;
  for (const UnseenFrames& span : fit.unseen)
    unseen.push_back(span.joint + " " + std::to_string(span.first) + "-" + std::to_string(span.last));
  EXPECT_THAT(unseen, ::testing::IsSupersetOf({"LWrist 40-45", "LWrist 60-69", "RFoot 0-9", "LElbow 80-80"}));
  EXPECT_THAT(fit.never_seen, ::testing::ElementsAre("Head"));  // a nose that was not seen is left out
  // Where nobody is seen, the body goes on from where it was to where it will be.
  std::vector<Vector3d> before;
  std::vector<Vector3d> hidden;
  std::vector<Vector3d> expected;
  std::vector<Quaterniond> rotations;
  ForwardKinematics(fit.motion, 43, hidden, rotations);
  ForwardKinematics(truth.motion, 43, expected, rotations);
  EXPECT_LT((hidden[0] - expected[0]).norm(), 30.0);
}

TEST(FitHierarchy, UnseenLegsHangFromWhatIsSeen) {
  const Skeleton& skeleton = SkeletonNamed("h36m-17");
  HierarchyFit truth = TPoseHierarchy(skeleton, JointNames::kOurs);
  Animate(20, 0.0, truth);
  PoseSequence person = PosesOf(truth, skeleton);
  for (int t = 0; t < 20; ++t) {
    for (const char* joint : {"LKnee", "RKnee", "LFoot", "RFoot"})
      person.PoseAt(t).row(*skeleton.Find(joint)).setConstant(std::nanf(""));
  }
  const HierarchyFit fit = FitHierarchy(person, JointNames::kOurs);
  EXPECT_LT(fit.largest_error_mm, 1.0);
  EXPECT_THAT(fit.never_seen, ::testing::ElementsAre("LKnee", "LFoot", "RKnee", "RFoot"));
  std::map<std::string, Vector3d> rest = RestByName(fit.motion);
  EXPECT_NEAR((rest["LHip"] - rest["LFoot"]).norm(), 0.491 * fit.stature_mm, 1.0);
}

TEST(FitHierarchy, SaysWhatItNeeds) {
  Skeleton animal;
  animal.joints = {"tail", "snout"};
  animal.parents = {-1, 0};
  animal.mirror = {0, 1};
  PoseSequence one(animal, 3);
  one.unit = LengthUnit::kMillimetres;
  one.name = "rex";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FitHierarchy(one, JointNames::kOurs); }),
              ::testing::AllOf(::testing::HasSubstr("rex"), ::testing::HasSubstr("LHip")));
  PoseSequence nobody(SkeletonNamed("h36m-17"), 3);
  nobody.unit = LengthUnit::kMillimetres;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FitHierarchy(nobody, JointNames::kOurs); }),
              ::testing::HasSubstr("none in any"));
  EXPECT_THROW(FitHierarchy(PoseSequence(SkeletonNamed("h36m-17"), 3), JointNames::kOurs), std::logic_error);
}

// Real motion: shoulders, spine and neck are not rigid, so the fit has an error, which must be small.
TEST(FitHierarchy, FollowsRecordedMotion) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  int clips = 0;
  for (const std::filesystem::path& file : FindMotionFiles({Shared("data/cmu")})) {
    if (clips++ % 6 != 0) continue;
    const ArticulatedMotion motion = ReadMotion(file);
    const LandmarkTrack track = MakeLandmarkTrack(motion, file.string());
    const int frames = std::min(track.frame_count(), 1200);
    PoseSequence person(LandmarkSkeleton(), frames);
    person.unit = LengthUnit::kMillimetres;
    person.fps = track.fps;
    for (int t = 0; t < frames; ++t) {
      for (int j = 0; j < kLandmarkCount; ++j) person.PoseAt(t).row(j) = track.At(t, j).transpose().cast<float>();
    }
    const HierarchyFit fit = FitHierarchy(person, JointNames::kOurs);
    const auto [step, joint] = LargestStep(fit.motion);
    RecordProperty(file.stem().string(), std::to_string(fit.mean_error_mm));
    EXPECT_LT(fit.mean_error_mm, 8.0) << file;
    EXPECT_LT(fit.largest_error_mm, 80.0) << file << " " << fit.worst_joint << " " << fit.worst_frame;
    EXPECT_LT(step, 45.0) << file << " " << joint;  // in 1/120 s; the files' own joints turn by up to 26 degrees
  }
  EXPECT_GT(clips, 0);
}

}  // namespace
}  // namespace canonpose
