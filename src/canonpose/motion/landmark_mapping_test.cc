#include "canonpose/motion/landmark_mapping.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/motion/motion_files.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::Shared;

struct NamedJoint {
  const char* name;
  const char* parent;
  Vector3d position_mm;  // in the rest pose
};

/// One frame of a body in its rest pose, as it stands.
ArticulatedMotion Standing(const std::vector<NamedJoint>& joints) {
  ArticulatedMotion motion;
  motion.fps = 100.0;
  std::map<std::string, int> index;
  for (const NamedJoint& joint : joints) {
    const bool is_root = motion.joints.empty();
    const int parent = is_root ? -1 : index.at(joint.parent);
    const Vector3d from = is_root ? joint.position_mm : joints[static_cast<std::size_t>(parent)].position_mm;
    index[joint.name] = motion.joint_count();
    motion.joints.push_back({joint.name, parent, joint.position_mm - from});
  }
  motion.root_position_mm = {joints.front().position_mm};
  motion.parent_from_joint.assign(joints.size(), Eigen::Quaterniond::Identity());
  return motion;
}

/// A person of 1.75 m who stands with arms out, facing -y, left is +x; joints as Mixamo names them.
std::vector<NamedJoint> MixamoBody() {
  return {{"mixamorig:Hips", "", {0, 0, 970}},
          {"mixamorig:Spine", "mixamorig:Hips", {0, 0, 1070}},
          {"mixamorig:Spine1", "mixamorig:Spine", {0, 0, 1200}},
          {"mixamorig:Spine2", "mixamorig:Spine1", {0, 0, 1330}},
          {"mixamorig:Neck", "mixamorig:Spine2", {0, 0, 1480}},
          {"mixamorig:Head", "mixamorig:Neck", {0, -20, 1560}},
          {"mixamorig:HeadTop_End", "mixamorig:Head", {0, -20, 1750}},
          {"mixamorig:LeftShoulder", "mixamorig:Spine2", {50, 0, 1440}},
          {"mixamorig:LeftArm", "mixamorig:LeftShoulder", {180, 0, 1430}},
          {"mixamorig:LeftForeArm", "mixamorig:LeftArm", {460, 0, 1430}},
          {"mixamorig:LeftHand", "mixamorig:LeftForeArm", {720, 0, 1430}},
          {"mixamorig:RightShoulder", "mixamorig:Spine2", {-50, 0, 1440}},
          {"mixamorig:RightArm", "mixamorig:RightShoulder", {-180, 0, 1430}},
          {"mixamorig:RightForeArm", "mixamorig:RightArm", {-460, 0, 1430}},
          {"mixamorig:RightHand", "mixamorig:RightForeArm", {-720, 0, 1430}},
          {"mixamorig:LeftUpLeg", "mixamorig:Hips", {90, 0, 930}},
          {"mixamorig:LeftLeg", "mixamorig:LeftUpLeg", {90, 0, 500}},
          {"mixamorig:LeftFoot", "mixamorig:LeftLeg", {90, 0, 75}},
          {"mixamorig:LeftToeBase", "mixamorig:LeftFoot", {90, -130, 15}},
          {"mixamorig:RightUpLeg", "mixamorig:Hips", {-90, 0, 930}},
          {"mixamorig:RightLeg", "mixamorig:RightUpLeg", {-90, 0, 500}},
          {"mixamorig:RightFoot", "mixamorig:RightLeg", {-90, 0, 75}},
          {"mixamorig:RightToeBase", "mixamorig:RightFoot", {-90, -130, 15}}};
}

/// The same body under other names.
ArticulatedMotion Renamed(const std::vector<std::pair<std::string, std::string>>& names, bool only_these = false) {
  const std::string prefix = "mixamorig:";
  ArticulatedMotion motion = Standing(MixamoBody());
  for (MotionJoint& joint : motion.joints) {
    joint.name = joint.name.substr(prefix.size());
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.first == joint.name; });
    if (found != names.end()) {
      joint.name = found->second;
    } else if (only_these) {
      joint.name.insert(0, "other ");
    }
  }
  return motion;
}

void ExpectStandingPerson(const LandmarkTrack& track) {
  ASSERT_EQ(track.frame_count(), 1);
  const auto at = [&](int landmark) { return track.At(0, landmark); };
  const auto expect_at = [&](Landmark landmark, const Vector3d& expected, double tolerance_mm) {
    EXPECT_LT((at(landmark) - expected).norm(), tolerance_mm)
        << LandmarkSkeleton().joints[landmark] << " at " << at(landmark).transpose();
  };
  expect_at(kHip, {0, 0, 930}, 1e-6);
  expect_at(kLHip, {90, 0, 930}, 1e-6);
  expect_at(kRKnee, {-90, 0, 500}, 1e-6);
  expect_at(kLFoot, {90, 0, 75}, 1e-6);
  expect_at(kLShoulder, {180, 0, 1430}, 1e-6);
  expect_at(kRElbow, {-460, 0, 1430}, 1e-6);
  expect_at(kRWrist, {-720, 0, 1430}, 1e-6);
  expect_at(kThorax, {0, 0, 1430}, 15);
  expect_at(kSpine, {0, 0, 1167}, 30);
  // The head of an adult: the eyes at 0.936 of the stature, the chin at 0.87, the face in front.
  expect_at(kHead, {0, -20, 1750}, 25);
  expect_at(kNose, {0, -140, 1595}, 30);
  expect_at(kLEye, {32, -100, 1638}, 30);
  expect_at(kREye, {-32, -100, 1638}, 30);
  expect_at(kLEar, {75, -20, 1620}, 30);
  expect_at(kREar, {-75, -20, 1620}, 30);
  expect_at(kUpperNeck, {0, -10, 1495}, 30);
  expect_at(kLHeel, {90, 65, 10}, 25);
  expect_at(kRHeel, {-90, 65, 10}, 25);
  expect_at(kLBigToe, {73, -200, 20}, 25);
  expect_at(kRBigToe, {-73, -200, 20}, 25);
  expect_at(kLSmallToe, {146, -160, 20}, 25);
  expect_at(kRSmallToe, {-146, -160, 20}, 25);
}

TEST(LandmarkMapping, FindsJointsByTheNamesOfManyTools) {
  ExpectStandingPerson(MakeLandmarkTrack(Standing(MixamoBody()), "mixamo"));
  ExpectStandingPerson(MakeLandmarkTrack(Renamed({}), "motionbuilder"));
  const std::vector<std::pair<std::string, std::string>> poser = {
      {"LeftShoulder", "LeftCollar"}, {"LeftArm", "LeftShoulder"},    {"LeftForeArm", "LeftElbow"},
      {"LeftHand", "LeftWrist"},      {"LeftUpLeg", "LeftHip"},       {"LeftLeg", "LeftKnee"},
      {"LeftFoot", "LeftAnkle"},      {"LeftToeBase", "LeftToe"},     {"RightShoulder", "RightCollar"},
      {"RightArm", "RightShoulder"},  {"RightForeArm", "RightElbow"}, {"RightHand", "RightWrist"},
      {"RightUpLeg", "RightHip"},     {"RightLeg", "RightKnee"},      {"RightFoot", "RightAnkle"},
      {"RightToeBase", "RightToe"}};
  ExpectStandingPerson(MakeLandmarkTrack(Renamed(poser), "biovision"));
  const std::vector<std::pair<std::string, std::string>> smpl = {
      {"Hips", "Pelvis"},        {"LeftShoulder", "L_Collar"},  {"LeftArm", "L_Shoulder"},  {"LeftForeArm", "L_Elbow"},
      {"LeftHand", "L_Wrist"},   {"LeftUpLeg", "L_Hip"},        {"LeftLeg", "L_Knee"},      {"LeftFoot", "L_Ankle"},
      {"LeftToeBase", "L_Foot"}, {"RightShoulder", "R_Collar"}, {"RightArm", "R_Shoulder"}, {"RightForeArm", "R_Elbow"},
      {"RightHand", "R_Wrist"},  {"RightUpLeg", "R_Hip"},       {"RightLeg", "R_Knee"},     {"RightFoot", "R_Ankle"},
      {"RightToeBase", "R_Foot"}};
  ExpectStandingPerson(MakeLandmarkTrack(Renamed(smpl), "smpl"));
  const std::vector<std::pair<std::string, std::string>> blender = {
      {"LeftShoulder", "shoulder.L"}, {"LeftArm", "upper_arm.L"},    {"LeftForeArm", "forearm.L"},
      {"LeftHand", "hand.L"},         {"LeftUpLeg", "thigh.L"},      {"LeftLeg", "shin.L"},
      {"LeftFoot", "foot.L"},         {"LeftToeBase", "toe.L"},      {"RightShoulder", "shoulder.R"},
      {"RightArm", "upper_arm.R"},    {"RightForeArm", "forearm.R"}, {"RightHand", "hand.R"},
      {"RightUpLeg", "thigh.R"},      {"RightLeg", "shin.R"},        {"RightFoot", "foot.R"},
      {"RightToeBase", "toe.R"}};
  ExpectStandingPerson(MakeLandmarkTrack(Renamed(blender), "blender"));
  ArticulatedMotion prefixed = Renamed({});
  for (MotionJoint& joint : prefixed.joints) joint.name = "Character1_" + joint.name;
  ExpectStandingPerson(MakeLandmarkTrack(prefixed, "prefixed"));
}

TEST(LandmarkMapping, OurOwnNamesMeanTheLandmarks) {
  // Crown, thorax, spine, and a nose that is longer than any person's.
  const ArticulatedMotion motion = Standing({{"Hip", "", {0, 0, 970}},
                                             {"Spine", "Hip", {0, 5, 1170}},
                                             {"Thorax", "Spine", {0, 10, 1440}},
                                             {"UpperNeck", "Thorax", {0, 0, 1500}},
                                             {"Head", "UpperNeck", {0, 0, 1750}},
                                             {"Nose", "UpperNeck", {0, -300, 1600}},
                                             {"LShoulder", "Thorax", {180, 0, 1430}},
                                             {"LElbow", "LShoulder", {180, 0, 1130}},
                                             {"LWrist", "LElbow", {180, 0, 880}},
                                             {"RShoulder", "Thorax", {-180, 0, 1430}},
                                             {"RElbow", "RShoulder", {-180, 0, 1130}},
                                             {"RWrist", "RElbow", {-180, 0, 880}},
                                             {"LHip", "Hip", {90, 0, 930}},
                                             {"LKnee", "LHip", {90, 0, 500}},
                                             {"LFoot", "LKnee", {90, 0, 75}},
                                             {"LHeel", "LFoot", {90, 77, 11}},
                                             {"RHip", "Hip", {-90, 0, 930}},
                                             {"RKnee", "RHip", {-90, 0, 500}},
                                             {"RFoot", "RKnee", {-90, 0, 75}}});
  const LandmarkTrack track = MakeLandmarkTrack(motion, "ours");
  for (const auto& [landmark, expected] : {std::pair<Landmark, Vector3d>{kHip, {0, 0, 930}},
                                           {kSpine, {0, 5, 1170}},
                                           {kThorax, {0, 10, 1440}},
                                           {kUpperNeck, {0, 0, 1500}},
                                           {kHead, {0, 0, 1750}},
                                           {kNose, {0, -300, 1600}},
                                           {kLHeel, {90, 77, 11}},
                                           {kRWrist, {-180, 0, 880}}}) {
    EXPECT_LT((track.At(0, landmark) - expected).norm(), 1e-6) << LandmarkSkeleton().joints[landmark];
  }
  EXPECT_LT((track.At(0, kRHeel) - Vector3d(-90, 65, 10)).norm(), 25.0);
  EXPECT_LT((track.At(0, kLEye) - Vector3d(32, -80, 1638)).norm(), 30.0);
  // A prefix changes nothing.
  for (const char* prefix : {"mixamorig:", "Character1_"}) {
    ArticulatedMotion prefixed = motion;
    for (MotionJoint& joint : prefixed.joints) joint.name = prefix + joint.name;
    const LandmarkTrack same = MakeLandmarkTrack(prefixed, "prefixed");
    for (int landmark = 0; landmark < kLandmarkCount; ++landmark) {
      EXPECT_EQ(same.At(0, landmark), track.At(0, landmark)) << prefix << LandmarkSkeleton().joints[landmark];
    }
  }
}

TEST(LandmarkMapping, TheFaceTurnsWithTheHeadAndTheToesWithTheFoot) {
  ArticulatedMotion motion = Standing(MixamoBody());
  const LandmarkTrack before = MakeLandmarkTrack(motion, "before");
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    // The head to the left, the left foot's toes up.
    if (motion.joints[j].name == "mixamorig:Head") {
      motion.parent_from_joint[j] = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ());
    }
    if (motion.joints[j].name == "mixamorig:LeftFoot") {
      motion.parent_from_joint[j] = Eigen::AngleAxisd(-M_PI / 6, Vector3d::UnitX());
    }
  }
  const LandmarkTrack after = MakeLandmarkTrack(motion, "after");
  EXPECT_GT(after.At(0, kNose).x(), 80.0);
  EXPECT_NEAR(after.At(0, kNose).z(), before.At(0, kNose).z(), 1e-6);
  EXPECT_LT(after.At(0, kREar).y(), -60.0);
  EXPECT_GT(after.At(0, kLBigToe).z(), before.At(0, kLBigToe).z() + 60.0);
  EXPECT_LT(after.At(0, kLHeel).z(), before.At(0, kLHeel).z() - 20.0);
  for (const Landmark still : {kThorax, kSpine, kLShoulder, kRBigToe, kLFoot}) {
    EXPECT_LT((after.At(0, still) - before.At(0, still)).norm(), 1e-6) << still;
  }
}

TEST(LandmarkMapping, NamesTheJointsThatAreMissing) {
  const ArticulatedMotion motion = Renamed({{"LeftFoot", "Thing"}, {"RightForeArm", "Other"}});
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeLandmarkTrack(motion, "a.bvh"); }),
              AllOf(HasSubstr("a.bvh"), HasSubstr("expected LFoot, RElbow under"), HasSubstr("Hips, Spine")));
  ArticulatedMotion flat = Renamed({});
  for (MotionJoint& joint : flat.joints) joint.offset_mm.setZero();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeLandmarkTrack(flat, "a.bvh"); }), HasSubstr("rest pose"));
}

// Properties of any recorded clip. Each measure depends on one side or on the body's frame, so that it changes if left
// and right are swapped or the world is mirrored.

Vector3d Unit(const Vector3d& v) { return v.normalized(); }

/// The direction over the ground that the pelvis faces: left x up.
Vector3d Facing(const LandmarkTrack& track, int t) {
  Vector3d left = track.At(t, kLHip) - track.At(t, kRHip);
  left.z() = 0.0;
  return Unit(left).cross(Vector3d::UnitZ());
}

double MeanOverFrames(const LandmarkTrack& track, const std::function<double(int)>& value) {
  double sum = 0.0;
  for (int t = 0; t < track.frame_count(); ++t) sum += value(t);
  return sum / track.frame_count();
}

/// Mean cosine between the directions in which the pelvis moves and faces, over frames at walking speed.
double WalksForward(const LandmarkTrack& track) {
  constexpr int kStep = 12;
  double sum = 0.0;
  int count = 0;
  for (int t = kStep; t + kStep < track.frame_count(); t += kStep) {
    Vector3d way = track.At(t + kStep, kHip) - track.At(t - kStep, kHip);
    way.z() = 0.0;
    if (way.norm() * track.fps / (2 * kStep) < 500.0) continue;
    sum += Unit(way).dot(Facing(track, t));
    ++count;
  }
  EXPECT_GT(count, 5) << track.name;
  return sum / count;
}

/// Mean distance by which a landmark is in front of another, mm.
double Ahead(const LandmarkTrack& track, Landmark of, Landmark from) {
  return MeanOverFrames(track, [&](int t) { return (track.At(t, of) - track.At(t, from)).dot(Facing(track, t)); });
}

/// Mean bend of a hinge about the axis of the hips or shoulders to the left, as the sine of the angle: positive for a
/// knee that bends the shank backward, negative for an elbow that bends the forearm forward.
double Bend(const LandmarkTrack& track, Landmark top, Landmark hinge, Landmark end, Landmark left, Landmark right) {
  return MeanOverFrames(track, [&](int t) {
    const Vector3d upper = Unit(track.At(t, hinge) - track.At(t, top));
    const Vector3d lower = Unit(track.At(t, end) - track.At(t, hinge));
    return upper.cross(lower).dot(Unit(track.At(t, left) - track.At(t, right)));
  });
}

/// In what way a walker does not look like one; empty if they do.
std::string FaultsOfAWalker(const LandmarkTrack& track) {
  std::string faults;
  const auto require = [&](bool holds, const char* what) {
    if (!holds) faults += std::string(what) + "; ";
  };
  require(WalksForward(track) > 0.9, "walks where it faces");
  require(Ahead(track, kLBigToe, kLHeel) > 150.0 && Ahead(track, kRBigToe, kRHeel) > 150.0, "toes before heels");
  require(Ahead(track, kNose, kLEar) > 60.0 && Ahead(track, kNose, kREar) > 60.0, "nose before ears");
  require(Ahead(track, kLFoot, kLKnee) < -50.0 && Ahead(track, kRFoot, kRKnee) < -50.0, "shanks go backward");
  require(Ahead(track, kLWrist, kLElbow) > 50.0 && Ahead(track, kRWrist, kRElbow) > 50.0, "forearms go forward");
  require(
      Bend(track, kLHip, kLKnee, kLFoot, kLHip, kRHip) > 0.1 && Bend(track, kRHip, kRKnee, kRFoot, kLHip, kRHip) > 0.1,
      "knees bend backward");
  require(Bend(track, kLShoulder, kLElbow, kLWrist, kLShoulder, kRShoulder) < -0.1 &&
              Bend(track, kRShoulder, kRElbow, kRWrist, kLShoulder, kRShoulder) < -0.1,
          "elbows bend forward");
  return faults;
}

LandmarkTrack Swapped(const LandmarkTrack& track) {
  LandmarkTrack swapped = track;
  for (int t = 0; t < track.frame_count(); ++t) {
    for (int j = 0; j < kLandmarkCount; ++j) {
      const int partner = LandmarkSkeleton().mirror[static_cast<std::size_t>(j)];
      swapped.positions_mm[static_cast<std::size_t>(t * kLandmarkCount + j)] = track.At(t, partner);
    }
  }
  return swapped;
}

LandmarkTrack Mirrored(const LandmarkTrack& track) {
  LandmarkTrack mirrored = track;
  for (Vector3d& position : mirrored.positions_mm) position.x() = -position.x();
  return mirrored;
}

TEST(RecordedClips, WalkersShowLeftAndRight) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  for (const char* clip : {"02_01", "02_02"}) {
    const std::filesystem::path file = Shared("data/cmu/02") / (std::string(clip) + ".amc");
    const LandmarkTrack track = MakeLandmarkTrack(ReadMotion(file), file.string());
    EXPECT_EQ(FaultsOfAWalker(track), "") << clip;
    EXPECT_EQ(FaultsOfAWalker(Swapped(Mirrored(track))), "")
        << "a mirrored walker with swapped sides is a walker again";
    for (const LandmarkTrack& wrong : {Swapped(track), Mirrored(track)}) {
      for (const char* fault : {"walks", "toes", "nose", "shanks", "forearms", "knees", "elbows"}) {
        EXPECT_THAT(FaultsOfAWalker(wrong), HasSubstr(fault)) << clip;
      }
    }
    for (int t = 0; t < track.frame_count(); ++t) {
      const double ankles = std::max(track.At(t, kLFoot).z(), track.At(t, kRFoot).z());
      ASSERT_GT(track.At(t, kHip).z(), ankles + 300.0) << clip << " " << t;
      ASSERT_GT(track.At(t, kThorax).z(), track.At(t, kSpine).z() + 200.0) << clip << " " << t;
      ASSERT_GT(track.At(t, kHead).z(), track.At(t, kThorax).z() + 200.0) << clip << " " << t;
    }
  }
}

/// The names of the widely used conversion of CMU's clips to BVH, whose hand is where CMU's lower forearm begins.
TEST(RecordedClips, HaveTheSameLandmarksUnderTheNamesOfTheirConversion) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  const std::map<std::string, std::string> names = {
      {"root", "Hips"},         {"lowerback", "LowerBack"}, {"upperback", "Spine"}, {"thorax", "Spine1"},
      {"lowerneck", "Neck"},    {"upperneck", "Neck1"},     {"head", "Head"},       {"hipjoint", "HipJoint"},
      {"femur", "UpLeg"},       {"tibia", "Leg"},           {"foot", "Foot"},       {"toes", "ToeBase"},
      {"clavicle", "Shoulder"}, {"humerus", "Arm"},         {"radius", "ForeArm"},  {"wrist", "Hand"},
      {"hand", "FingerBase"},   {"fingers", "HandIndex1"},  {"thumb", "Thumb"}};
  const std::filesystem::path file = Shared("data/cmu/02/02_01.amc");
  ArticulatedMotion motion = ReadMotion(file);
  const LandmarkTrack expected = MakeLandmarkTrack(motion, file.string());
  for (MotionJoint& joint : motion.joints) {
    const bool is_end = joint.name.ends_with("_end");
    const std::string bone = joint.name.substr(0, joint.name.size() - (is_end ? 4 : 0));
    const auto whole = names.find(bone);
    const std::string side = bone.substr(1) == "hipjoint" || bone.substr(1) == "thumb" ? bone[0] == 'l' ? "L" : "R"
                             : bone[0] == 'l'                                          ? "Left"
                                                                                       : "Right";
    joint.name = (whole != names.end() ? whole->second : side + names.at(bone.substr(1))) + (is_end ? "_end" : "");
  }
  const LandmarkTrack converted = MakeLandmarkTrack(motion, file.string());
  for (std::size_t i = 0; i < expected.positions_mm.size(); ++i) {
    ASSERT_LT((expected.positions_mm[i] - converted.positions_mm[i]).norm(), 1e-6)
        << LandmarkSkeleton().joints[i % kLandmarkCount];
  }
}

/// Landmarks that are points of one rigid segment.
const std::vector<std::pair<Landmark, Landmark>>& RigidPairs() {
  static const std::vector<std::pair<Landmark, Landmark>> pairs = {
      {kHip, kRHip},    {kHip, kLHip},         {kRHip, kRKnee},        {kLHip, kLKnee},       {kRKnee, kRFoot},
      {kLKnee, kLFoot}, {kRShoulder, kRElbow}, {kLShoulder, kLElbow},  {kRElbow, kRWrist},    {kLElbow, kLWrist},
      {kNose, kHead},   {kREye, kLEye},        {kREar, kLEar},         {kNose, kREar},        {kLBigToe, kLSmallToe},
      {kRFoot, kRHeel}, {kLFoot, kLHeel},      {kRBigToe, kRSmallToe}, {kRShoulder, kThorax}, {kLShoulder, kThorax}};
  return pairs;
}

TEST(RecordedClips, AllLoadAndTheirBodiesAreRigidAndOfHumanSize) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  const std::vector<std::filesystem::path> files = FindMotionFiles({Shared("data/cmu")});
  EXPECT_EQ(files.size(), 24U);
  std::map<std::string, std::vector<double>> lengths_of;
  for (const std::filesystem::path& file : files) {
    const ArticulatedMotion motion = ReadMotion(file);
    EXPECT_EQ(motion.fps, 120.0);
    EXPECT_EQ(motion.subject, file.parent_path().filename().string());
    const LandmarkTrack track = MakeLandmarkTrack(motion, file.string());
    ASSERT_GT(track.frame_count(), 100) << file;
    std::vector<double>& lengths = lengths_of[motion.subject];
    for (int t = 0; t < track.frame_count(); ++t) {
      const bool is_first = lengths.empty();
      for (std::size_t p = 0; p < RigidPairs().size(); ++p) {
        const auto [a, b] = RigidPairs()[p];
        const double length = (track.At(t, a) - track.At(t, b)).norm();
        if (is_first) lengths.push_back(length);
        ASSERT_NEAR(length, lengths[p], 1.0) << file << " " << t << " " << LandmarkSkeleton().joints[a];
      }
      const double stature = StatureMm(&track.positions_mm[static_cast<std::size_t>(t) * kLandmarkCount]);
      ASSERT_GT(stature, 1500.0) << file << " " << t;
      ASSERT_LT(stature, 2000.0) << file << " " << t;
    }
    // Feet stay above the ground, even those of climbers and jumpers.
    std::vector<double> lowest;
    for (int t = 0; t < track.frame_count(); ++t) {
      lowest.push_back(std::min(
          {track.At(t, kLHeel).z(), track.At(t, kRHeel).z(), track.At(t, kLBigToe).z(), track.At(t, kRBigToe).z()}));
    }
    std::nth_element(lowest.begin(), lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 20), lowest.end());
    EXPECT_NEAR(lowest[lowest.size() / 20], 0.0, 60.0) << file;
    // Whatever people do, knees do not bend forward and faces look ahead more often than back.
    EXPECT_GT(Bend(track, kLHip, kLKnee, kLFoot, kLHip, kRHip), 0.1) << file;
    EXPECT_GT(Bend(track, kRHip, kRKnee, kRFoot, kLHip, kRHip), 0.1) << file;
    EXPECT_GT(MeanOverFrames(
                  track, [&](int t) { return Unit(track.At(t, kNose) - track.At(t, kREar)).dot(Facing(track, t)); }),
              0.2)
        << file;
  }
}

}  // namespace
}  // namespace canonpose
