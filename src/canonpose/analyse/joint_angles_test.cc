#include "canonpose/analyse/joint_angles.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/analyse/figure_testing.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/motion_files.h"

namespace canonpose {
namespace {

using ::testing::Each;
using testing::Figure;
using testing::Moving;
using testing::Posture;

std::vector<TimeSeries> Angles(const PoseSequence& person, bool up_is_known = true) {
  return JointAngles(person, FindBodyJoints(person), up_is_known);
}

std::vector<double> Values(const std::vector<TimeSeries>& angles, const std::string& name) {
  const TimeSeries* series = FindSeries(angles, name);
  EXPECT_NE(series, nullptr) << name;
  return series == nullptr ? std::vector<double>() : series->values;
}

double Angle(const PoseSequence& person, const std::string& name, std::size_t frame = 0) {
  return Values(Angles(person), name).at(frame);
}

void ExpectAngles(const PoseSequence& person, const std::vector<Posture>& expected, double tolerance_deg = 0.01) {
  const std::vector<TimeSeries> angles = Angles(person);
  for (std::size_t t = 0; t < expected.size(); ++t) {
    for (const auto& [name, degrees] : expected[t]) {
      EXPECT_NEAR(Values(angles, name).at(t), degrees, tolerance_deg) << name << " in frame " << t;
    }
  }
}

/// Every angle that the figure has, each different, within what bodies can do.
Posture Everything(double part = 1.0) {
  Posture posture = {
      {"pelvis_tilt", -12},   {"pelvis_list", 7},        {"pelvis_rotation", 25}, {"lumbar_extension", -15},
      {"lumbar_bending", 9},  {"lumbar_rotation", -11},  {"hip_flexion_r", 38},   {"hip_adduction_r", -14},
      {"hip_rotation_r", 13}, {"knee_angle_r", 52},      {"ankle_angle_r", 17},   {"ankle_inversion_r", -8},
      {"hip_flexion_l", -16}, {"hip_adduction_l", 6},    {"hip_rotation_l", -21}, {"knee_angle_l", 33},
      {"ankle_angle_l", -24}, {"ankle_inversion_l", 12}, {"arm_flex_r", 61},      {"arm_add_r", -27},
      {"arm_rot_r", 34},      {"elbow_flex_r", 95},      {"arm_flex_l", -31},     {"arm_add_l", -49},
      {"arm_rot_l", -43},     {"elbow_flex_l", 44}};
  for (auto& [name, degrees] : posture) degrees *= part;
  return posture;
}

TEST(JointAngles, AreExactlyThoseOfTheMotion) {
  const std::vector<Posture> postures = {Everything(), Everything(0.9), Everything(0.6), Everything(0.4)};
  ExpectAngles(Moving(postures), postures);
}

TEST(JointAngles, OfTheNeutralPostureAreZero) {
  // Bent just so far that the axes of knees and elbows can be told.
  const Posture neutral = {{"knee_angle_r", 15}, {"knee_angle_l", 15}, {"elbow_flex_r", 15}, {"elbow_flex_l", 15}};
  for (const TimeSeries& angle : Angles(Moving({neutral}))) {
    if (angle.name.starts_with("elv_angle")) continue;  // a hanging arm has no plane of elevation
    const auto bent = neutral.find(angle.name);
    EXPECT_NEAR(angle.values.front(), bent == neutral.end() ? 0.0 : bent->second, 0.01) << angle.name;
  }
}

/// Where a joint goes when an angle grows from 0 to 20 degrees: the docs' table of signs, in directions of a person who
/// faces along x (left is y, up is z).
TEST(JointAngles, GrowInTheDirectionThatTheirNamesSay) {
  struct Sign {
    const char* angle;
    const char* joint;
    const char* about;  // the joint that stays
    Eigen::Vector3d direction;
  };
  const Eigen::Vector3d forward(1, 0, 0);
  const Eigen::Vector3d left(0, 1, 0);
  const Eigen::Vector3d up(0, 0, 1);
  const std::vector<Sign> signs = {
      {"pelvis_tilt", "Spine", "Hip", -forward},         {"pelvis_list", "RHip", "Hip", -up},
      {"pelvis_rotation", "RHip", "Hip", forward},       {"lumbar_extension", "Thorax", "Spine", -forward},
      {"lumbar_bending", "Thorax", "Spine", -left},      {"lumbar_rotation", "RShoulder", "Thorax", forward},
      {"hip_flexion_r", "RKnee", "RHip", forward},       {"hip_flexion_l", "LKnee", "LHip", forward},
      {"hip_adduction_r", "RKnee", "RHip", left},        {"hip_adduction_l", "LKnee", "LHip", -left},
      {"hip_rotation_r", "RBigToe", "RHeel", left},      {"hip_rotation_l", "LBigToe", "LHeel", -left},
      {"knee_angle_r", "RFoot", "RKnee", -forward},      {"knee_angle_l", "LFoot", "LKnee", -forward},
      {"ankle_angle_r", "RBigToe", "RHeel", up},         {"ankle_angle_l", "LBigToe", "LHeel", up},
      {"ankle_inversion_r", "RBigToe", "RSmallToe", up}, {"ankle_inversion_l", "LBigToe", "LSmallToe", up},
      {"ankle_rotation_r", "RBigToe", "RHeel", left},    {"ankle_rotation_l", "LBigToe", "LHeel", -left},
      {"arm_flex_r", "RElbow", "RShoulder", forward},    {"arm_flex_l", "LElbow", "LShoulder", forward},
      {"arm_add_r", "RElbow", "RShoulder", left},        {"arm_add_l", "LElbow", "LShoulder", -left},
      {"arm_rot_r", "RWrist", "RElbow", left},           {"arm_rot_l", "LWrist", "LElbow", -left},
      {"elbow_flex_r", "RWrist", "RElbow", forward},     {"elbow_flex_l", "LWrist", "LElbow", forward}};
  for (const Sign& sign : signs) {
    Posture before = {{"knee_angle_r", 11}, {"knee_angle_l", 11}, {"elbow_flex_r", 11}, {"elbow_flex_l", 11}};
    Posture after = before;
    after[sign.angle] += 20;
    const auto at = [&](const Posture& posture) {
      const Figure figure(posture);
      return Eigen::Vector3d(figure.joints().at(sign.joint) - figure.joints().at(sign.about));
    };
    EXPECT_GT((at(after) - at(before)).normalized().dot(sign.direction), 0.5) << sign.angle;
    EXPECT_NEAR(Angle(Moving({after}), sign.angle), after[sign.angle], 0.01) << sign.angle;
  }
}

TEST(JointAngles, OfMirroredPosesAreMirrored) {
  const PoseSequence person = Moving({Everything(), Everything(0.5)});
  PoseSequence mirrored = person;
  for (int t = 0; t < person.frame_count(); ++t) {
    for (int j = 0; j < person.joint_count(); ++j) {
      const int partner = person.skeleton().mirror[static_cast<std::size_t>(j)];
      mirrored.PoseAt(t).row(j) = person.PoseAt(t).row(partner);
      mirrored.PoseAt(t)(j, 1) *= -1.0F;
    }
  }
  const std::vector<TimeSeries> before = Angles(person);
  const std::vector<TimeSeries> after = Angles(mirrored);
  ASSERT_EQ(after.size(), before.size());
  for (const TimeSeries& angle : before) {
    std::string name = angle.name;
    double sign = 1.0;
    if (name.ends_with("_r") || name.ends_with("_l")) {
      name.back() = name.back() == 'r' ? 'l' : 'r';
    } else if (!name.ends_with("_tilt") && !name.ends_with("_extension")) {
      sign = -1.0;
    }
    for (std::size_t t = 0; t < 2; ++t) {
      EXPECT_NEAR(Values(after, name).at(t), sign * angle.values[t], 1e-3) << angle.name << " in frame " << t;
    }
  }
}

TEST(JointAngles, DoNotDependOnPlaceSizeAndHeading) {
  const PoseSequence person = Moving({Everything()});
  PoseSequence moved = person;
  const Eigen::AngleAxisf turn(2.0F, Eigen::Vector3f::UnitZ());
  for (int j = 0; j < person.joint_count(); ++j) {
    const Eigen::Vector3f at = person.PoseAt(0).row(j).transpose();
    moved.PoseAt(0).row(j) = (0.002F * (turn * at) + Eigen::Vector3f(3, -4, 5)).transpose();
  }
  const std::vector<TimeSeries> after = Angles(moved);
  for (const TimeSeries& angle : Angles(person)) {
    const bool turns = angle.name == "pelvis_rotation" || angle.name == "trunk_rotation";
    const double expected = angle.values[0] + (turns ? DegFromRad(2.0) : 0.0);
    EXPECT_NEAR(Values(after, angle.name).at(0), expected, 0.01) << angle.name;
  }
}

TEST(JointAngles, UnknownJointsMakeTheirAnglesUnknownAndNoOthers) {
  PoseSequence person = Moving({Everything(), Everything()});
  person.PoseAt(1).row(person.skeleton().Find("RKnee").value()).setConstant(std::nanf(""));
  const std::vector<std::string> unknown = {"hip_flexion_r", "hip_adduction_r",   "hip_rotation_r",  "knee_angle_r",
                                            "ankle_angle_r", "ankle_inversion_r", "ankle_rotation_r"};
  for (const TimeSeries& angle : Angles(person)) {
    const bool expected = std::find(unknown.begin(), unknown.end(), angle.name) != unknown.end();
    EXPECT_EQ(std::isnan(angle.values[1]), expected) << angle.name;
    EXPECT_FALSE(std::isnan(angle.values[0])) << angle.name;
  }
}

TEST(JointAngles, AStraightLimbHasNoRotationAboutItself) {
  Posture straight = Everything();
  straight["knee_angle_r"] = 6;
  straight["elbow_flex_l"] = 6;
  const PoseSequence person = Moving({straight});
  EXPECT_TRUE(std::isnan(Angle(person, "hip_rotation_r")));
  EXPECT_TRUE(std::isnan(Angle(person, "ankle_inversion_r")));
  EXPECT_TRUE(std::isnan(Angle(person, "arm_rot_l")));
  for (const char* name : {"hip_rotation_r", "ankle_inversion_r", "arm_rot_l"}) straight.erase(name);
  ExpectAngles(person, {straight});
}

TEST(JointAngles, AKneeThatSeemsBentForwardsHasNoHipRotation) {
  const PoseSequence person = Moving({{{"knee_angle_r", -14}, {"hip_flexion_r", 20}}});
  EXPECT_TRUE(std::isnan(Angle(person, "hip_rotation_r")));
  EXPECT_NEAR(Angle(person, "hip_flexion_r"), 20, 0.01);
  EXPECT_NEAR(Angle(person, "knee_angle_r"), 14, 0.01);
}

/// Postures in which one angle goes from a value to another in equal steps.
std::vector<Posture> Sweep(const Posture& posture, const std::string& angle, double from, double to, int frames) {
  std::vector<Posture> postures;
  for (int t = 0; t < frames; ++t) {
    postures.push_back(posture);
    postures.back()[angle] = from + (to - from) * t / (frames - 1);
  }
  return postures;
}

TEST(JointAngles, GoOnWhereArmsAreLiftedSidewaysBeyondTheShoulder) {
  for (const double elbow : {0.0, 40.0}) {  // with and without a known rotation
    std::vector<Posture> postures = Sweep({{"arm_flex_r", 8}, {"elbow_flex_r", elbow}}, "arm_add_r", -5, -165, 81);
    const std::vector<TimeSeries> angles = Angles(Moving(postures));
    for (std::size_t t = 0; t < postures.size(); ++t) {
      const double add = postures[t]["arm_add_r"];
      EXPECT_NEAR(Values(angles, "arm_add_r")[t], std::abs(add + 90) < 1 ? -90 : add, 1.1);
      const double flex = Values(angles, "arm_flex_r")[t];
      if (std::abs(add + 90) < kSmallestAngleDeg) {
        EXPECT_TRUE(std::isnan(flex) || std::abs(add + 90) > kSmallestAngleDeg - 0.1) << add;
      } else {
        EXPECT_NEAR(flex, 8, 0.1) << add;
        if (elbow > 0.0) {
          EXPECT_NEAR(Values(angles, "arm_rot_r")[t], 0, 0.1) << add;
        }
      }
    }
  }
}

TEST(JointAngles, AnArmThatComesDownInFrontIsFlexedAgain) {
  std::vector<Posture> postures = Sweep({{"elbow_flex_r", 40}}, "arm_add_r", 0, -178, 60);
  const std::vector<Posture> down = Sweep({{"elbow_flex_r", 40}}, "arm_flex_r", 178, 30, 60);
  postures.insert(postures.end(), down.begin(), down.end());
  const std::vector<TimeSeries> angles = Angles(Moving(postures));
  EXPECT_NEAR(Values(angles, "arm_flex_r").back(), 30, 0.1);
  EXPECT_NEAR(Values(angles, "arm_add_r").back(), 0, 0.1);
  EXPECT_NEAR(Values(angles, "arm_rot_r").back(), 0, 0.1);
}

TEST(JointAngles, DoNotJumpByFullTurns) {
  ExpectAngles(Moving(Sweep(Everything(), "pelvis_rotation", -100, 700, 90)),
               Sweep(Everything(), "pelvis_rotation", -100, 700, 90));
  ExpectAngles(Moving(Sweep(Everything(), "arm_flex_l", 0, 400, 60)), Sweep(Everything(), "arm_flex_l", 0, 400, 60));
  // Also over a gap.
  PoseSequence person = Moving(Sweep({}, "pelvis_rotation", 120, 240, 13));
  for (int t = 4; t < 9; ++t) person.PoseAt(t).setConstant(std::nanf(""));
  EXPECT_NEAR(Angle(person, "pelvis_rotation", 12), 240, 0.01);
}

TEST(JointAngles, ShoulderElevationAndItsPlaneHoldWhereFlexionDoesNot) {
  // Arms straight out to the sides, and straight to the front.
  const PoseSequence person =
      Moving({{{"arm_add_r", -90}, {"arm_add_l", -90}}, {{"arm_flex_r", 90}, {"arm_flex_l", 90}}});
  for (const std::string side : {"_r", "_l"}) {
    EXPECT_TRUE(std::isnan(Angle(person, "arm_flex" + side)));
    EXPECT_NEAR(Angle(person, "shoulder_elv" + side), 90, 0.01);
    EXPECT_NEAR(Angle(person, "elv_angle" + side), 0, 0.01);
    EXPECT_NEAR(Angle(person, "shoulder_elv" + side, 1), 90, 0.01);
    EXPECT_NEAR(Angle(person, "elv_angle" + side, 1), 90, 0.01);
  }
}

TEST(JointAngles, OnlyThoseAgainstTheFloorNeedUp) {
  const PoseSequence person = Moving({Everything()});
  const std::vector<TimeSeries> without = Angles(person, false);
  EXPECT_EQ(FindSeries(without, "pelvis_tilt"), nullptr);
  EXPECT_EQ(FindSeries(without, "trunk_list"), nullptr);
  EXPECT_EQ(without.size() + 6, Angles(person).size());
  EXPECT_NEAR(Values(without, "hip_flexion_r").at(0), 38, 0.01);
}

TEST(JointAngles, ASpineMadeFromHipsAndShouldersSaysNothing) {
  PoseSequence person = Moving({{{"lumbar_extension", -30}, {"lumbar_rotation", 20}}});
  const auto row = [&](const char* joint) {
    return person.PoseAt(0).row(person.skeleton().Find(joint).value()).eval();
  };
  EXPECT_NE(FindSeries(Angles(person), "lumbar_extension"), nullptr);
  person.PoseAt(0).row(person.skeleton().Find("Spine").value()) =
      (row("LHip") + row("RHip") + row("LShoulder") + row("RShoulder")) / 4.0F;
  const std::vector<TimeSeries> angles = Angles(person);
  EXPECT_EQ(FindSeries(angles, "lumbar_extension"), nullptr);
  // Turned about the line that bends with the trunk.
  EXPECT_NEAR(Values(angles, "lumbar_rotation").at(0), 20, 0.5);
  // The pelvis leans with the line from the hips to the shoulders: 300 of 500 mm bend by 30 degrees.
  const double lean = DegFromRad(std::atan2(300 * std::sin(RadFromDeg(30)), 200 + 300 * std::cos(RadFromDeg(30))));
  EXPECT_NEAR(Values(angles, "pelvis_tilt").at(0), -lean, 0.01);
  EXPECT_NEAR(Values(angles, "hip_flexion_r").at(0), lean, 0.01);
}

TEST(JointAngles, SkeletonsHaveTheAnglesThatTheirJointsAllow) {
  const std::vector<TimeSeries> h36m = Angles(Moving({Everything()}, *FindSkeleton("h36m-17")));
  EXPECT_EQ(FindSeries(h36m, "ankle_angle_r"), nullptr);
  EXPECT_NEAR(Values(h36m, "hip_rotation_l").at(0), -21, 0.01);
  PoseSequence stick(Skeleton{"", {"root", "tip"}, {-1, 0}, 0, {0, 1}}, {0, 0, 0, 1, 2, 3});
  EXPECT_TRUE(Angles(stick).empty());
  // A leg alone bends at its knee.
  PoseSequence leg(Skeleton{"", {"RHip", "RKnee", "RAnkle"}, {-1, 0, 1}, 0, {0, 1, 2}}, {0, 0, 2, 0, 0, 1, -1, 0, 1});
  ASSERT_EQ(Angles(leg).size(), 1U);
  EXPECT_NEAR(Angle(leg, "knee_angle_r"), 90, 1e-3);
}

TEST(JointAngles, TheFootFromTheAnkleWhereThereIsNoHeel) {
  const Skeleton skeleton{"", {"RHip", "RKnee", "RAnkle", "RBigToe"}, {-1, 0, 1, 2}, 0, {0, 1, 2, 3}};
  const PoseSequence person(skeleton, {0, 0, 2, 0, 0, 1, 0, 0, 0, 1, 0, -1});
  EXPECT_NEAR(Angle(person, "ankle_angle_r"), -45, 1e-3);
  EXPECT_EQ(FindSeries(Angles(person), "ankle_inversion_r"), nullptr);
}

TEST(OpenSimPelvis, PosesAModelThatTurnsInItsOrder) {
  const Posture posture = {{"pelvis_tilt", -20}, {"pelvis_list", 10}, {"pelvis_rotation", 110}};
  const std::vector<TimeSeries> pelvis = OpenSimPelvis(Moving({posture}));
  ASSERT_EQ(pelvis.size(), 3U);
  using Eigen::Vector3d;
  using testing::About;
  const Eigen::Matrix3d expected =
      About(Vector3d::UnitY(), 110) * About(Vector3d::UnitX(), 10) * About(Vector3d::UnitZ(), -20);
  const Eigen::Matrix3d posed = About(Vector3d::UnitZ(), Values(pelvis, "pelvis_tilt").at(0)) *
                                About(Vector3d::UnitX(), Values(pelvis, "pelvis_list").at(0)) *
                                About(Vector3d::UnitY(), Values(pelvis, "pelvis_rotation").at(0));
  EXPECT_LT((posed - expected).norm(), 1e-4) << posed;
}

/// CMU's shanks have one degree of freedom, so the hierarchy itself says how far the knee is bent.
TEST(JointAngles, OfMotionCaptureAreItsHierarchys) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  const std::vector<std::filesystem::path> files = FindMotionFiles({testing::Shared("data/cmu")});
  const ArticulatedMotion motion = ReadMotion(files.front());
  const LandmarkTrack track = MakeLandmarkTrack(motion, files.front().string());
  std::vector<float> positions;
  for (const Eigen::Vector3d& at : track.positions_mm) {
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(at[k]));
  }
  const PoseSequence person(LandmarkSkeleton(), std::move(positions));
  const std::vector<TimeSeries> angles = Angles(person);
  const std::map<std::string, std::string> bones = {
      {"knee_angle_r", "rtibia"}, {"knee_angle_l", "ltibia"}, {"elbow_flex_r", "rradius"}, {"elbow_flex_l", "lradius"}};
  for (const auto& [name, bone] : bones) {
    std::size_t joint = 0;
    while (motion.joints.at(joint).name != bone) ++joint;
    const std::vector<double> values = Values(angles, name);
    double smallest = 360;
    double largest = 0;
    for (std::size_t t = 0; t < values.size(); ++t) {
      const Eigen::AngleAxisd turn(motion.parent_from_joint[t * motion.joints.size() + joint]);
      EXPECT_NEAR(values[t], DegFromRad(turn.angle()), 0.1) << name << " in frame " << t;
      smallest = std::min(smallest, values[t]);
      largest = std::max(largest, values[t]);
    }
    EXPECT_GT(largest - smallest, 10) << name;
  }
}

TEST(Unwrap, ChoosesTheTurnNearestToTheLastKnownValue) {
  std::vector<double> degrees = {170, -175, std::nan(""), -100, 20, 100, -170};
  Unwrap(degrees);
  EXPECT_EQ(degrees[1], 185);
  EXPECT_EQ(degrees[3], 260);
  EXPECT_EQ(degrees[4], 380);
  EXPECT_EQ(degrees[6], 550);
}

}  // namespace
}  // namespace canonpose
