#include "canonpose/train/trap.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kPoseJoints = 12;

Eigen::Matrix3d TurnAbout(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(RadFromDeg(degrees), axis).toRotationMatrix();
}

/// Upright people, three times as high as wide, facing in all directions in front of two cameras that look down by
/// `tilt_degrees`; `exaggeration` multiplies their depth in the image's frame.
TrapSigns SignsOf(double exaggeration, double tilt_degrees) {
  Rng rng(4);
  TrapStatistics statistics;
  for (int frame = 0; frame < 600; ++frame) {
    Eigen::Matrix3Xd body(3, kPoseJoints);
    for (int j = 0; j < kPoseJoints; ++j) body.col(j) = Eigen::Vector3d(rng.Normal(), 3.0 * rng.Normal(), rng.Normal());
    for (int camera = 0; camera < 2; ++camera) {
      Eigen::Matrix3Xd pose =
          TurnAbout(Eigen::Vector3d::UnitX(), tilt_degrees) * TurnAbout(Eigen::Vector3d::UnitY(), 90.0 * camera) * body;
      pose.row(2) *= exaggeration;
      statistics.AddPose(frame / 25, camera, pose);
    }
  }
  return statistics.Finish();
}

TEST(TrapStatistics, PeopleSeenFromAllAroundAreAsDeepAsWide) {
  EXPECT_NEAR(SignsOf(1.0, 0.0).depth_ratio, 1.0, 0.05);
  EXPECT_NEAR(SignsOf(1.0, 35.0).depth_ratio, 1.0, 0.05);  // also where cameras look down on them
}

TEST(TrapStatistics, ExaggeratedDepthIsSeenAsSuch) {
  EXPECT_NEAR(SignsOf(0.7, 0.0).depth_ratio, 0.7, 0.04);
  EXPECT_NEAR(SignsOf(1.8, 0.0).depth_ratio, 1.8, 0.1);
  EXPECT_NEAR(SignsOf(2.5, 0.0).depth_ratio, 2.5, 0.15);
  EXPECT_GT(SignsOf(2.5, 20.0).depth_ratio, 1.6);
}

TEST(TrapStatistics, AnglesAndTheirScatterByHand) {
  TrapStatistics still;
  for (int frame = 0; frame < 40; ++frame) {
    still.AddRotation(0, 0, 1, TurnAbout(Eigen::Vector3d::UnitY(), 60.0 + (frame % 2 == 0 ? 5.0 : -5.0)));
    still.AddRotation(0, 0, 2, TurnAbout(Eigen::Vector3d::UnitY(), -120.0 + (frame % 2 == 0 ? 5.0 : -5.0)));
  }
  EXPECT_NEAR(still.Finish().scatter_deg, 5.0, 1e-6);
  EXPECT_NEAR(still.Finish().angle_deg, 115.0, 1e-6);  // of 55, 65, 115 and 125, the upper middle one

  // Half of the poses mirrored in depth: the rotations are each other's inverse, and their mean none at all.
  TrapStatistics mixed;
  for (int frame = 0; frame < 40; ++frame) {
    mixed.AddRotation(0, 0, 1, TurnAbout(Eigen::Vector3d::UnitY(), frame % 2 == 0 ? 60.0 : -60.0));
  }
  EXPECT_NEAR(mixed.Finish().scatter_deg, 60.0, 1e-6);
  // Groups do not mix.
  TrapStatistics apart;
  for (int frame = 0; frame < 40; ++frame) {
    apart.AddRotation(frame % 2, 0, 1, TurnAbout(Eigen::Vector3d::UnitY(), frame % 2 == 0 ? 60.0 : -60.0));
  }
  EXPECT_NEAR(apart.Finish().scatter_deg, 0.0, 1e-5);
}

TEST(JudgeTrap, ByDepthAndByScatter) {
  EXPECT_EQ(JudgeTrap({0.89, 108.0, 18.0}), TrapVerdict::kRight);
  EXPECT_EQ(JudgeTrap({1.01, 91.0, NAN}), TrapVerdict::kRight);
  EXPECT_EQ(JudgeTrap({1.93, 108.0, 18.0}), TrapVerdict::kTrapped);  // too deep
  EXPECT_EQ(JudgeTrap({1.0, 60.0, 60.0}), TrapVerdict::kTrapped);    // half of the poses mirrored
  EXPECT_EQ(JudgeTrap({1.35, 80.0, 18.0}), TrapVerdict::kSuspicious);
  EXPECT_EQ(JudgeTrap({1.0, 40.0, 20.0}), TrapVerdict::kSuspicious);
  EXPECT_EQ(JudgeTrap({0.3, 108.0, 18.0}), TrapVerdict::kSuspicious);
  EXPECT_EQ(JudgeTrap({1.16, 2.3, 0.8}), TrapVerdict::kSuspicious);  // hardly trained
  EXPECT_EQ(JudgeTrap({NAN, NAN, NAN}), TrapVerdict::kSuspicious);
}

TEST(ReportTrap, RecordsTheFiguresAndTheVerdict) {
  const TrapFinding finding = ReportTrap({1.93, 34.0, 33.0});
  EXPECT_EQ(finding.verdict, "trapped");
  EXPECT_EQ(finding.depth_ratio, 1.93);
  EXPECT_EQ(finding.angle_deg, 34.0);
  EXPECT_EQ(finding.scatter_deg, 33.0);
  EXPECT_EQ(ReportTrap({0.9, 100.0, 10.0}).verdict, "right");
}

TEST(ReportTrap, AdvisesNothingThatTheOptionsRefuse) {
  const auto advice = [](const InputForm& input) {
    const testing::CollectedMessages messages;
    ReportTrap({1.93, 34.0, 33.0}, input);
    return messages.text();
  };
  EXPECT_THAT(advice({}), Not(HasSubstr("ray=off")));
  EXPECT_THAT(advice({RayForm::kRoot, FocalSource::kGuess}), HasSubstr("`ray=off` and `camera_consistency=static`"));
}

/// A lifter with the same output everywhere: a body whose joints lie on the axes, and one rotation.
Lifter ConstantLifter(double depth, double yaw_degrees, RotationForm form = RotationForm::kAxisAngle) {
  Lifter lifter(7, 4, form);
  const torch::NoGradGuard no_grad;
  for (torch::Tensor& parameter : lifter->parameters()) parameter.zero_();
  torch::Tensor pose = torch::zeros({3, 7});
  const double extent[] = {1.0, 3.0, depth};
  for (int axis = 0; axis < 3; ++axis) {
    pose[axis][1 + 2 * axis] = extent[axis];
    pose[axis][2 + 2 * axis] = -extent[axis];
  }
  for (auto& item : lifter->named_parameters()) {
    if (item.key() == "pose3d.bias") item.value().copy_(pose.flatten());
    if (item.key() != "enc_rot.bias") continue;
    const double yaw = RadFromDeg(yaw_degrees);
    if (form == RotationForm::kAxisAngle) {
      item.value()[1] = yaw;
    } else {  // the first column, less the identity's
      item.value()[0] = std::cos(yaw) - 1.0;
      item.value()[2] = -std::sin(yaw);
    }
  }
  return lifter;
}

TrainingSet AnyViews(int frames) {
  TrainingSet set;
  set.joint_count = 7;
  set.static_captures = {1};
  for (int n = 0; n < frames; ++n) {
    set.frames.push_back({0, n / 25, {{0, 2 * n}, {1, 2 * n + 1}}});
    set.keypoints.insert(set.keypoints.end(), 2 * 14, 0.1F);
    set.confidence.insert(set.confidence.end(), 2 * 7, 1.0F);
  }
  return set;
}

class TrapOfForm : public ::testing::TestWithParam<RotationForm> {};

INSTANTIATE_TEST_SUITE_P(MeasureTrapSigns, TrapOfForm, ::testing::Values(RotationForm::kAxisAngle, RotationForm::kSix));

TEST_P(TrapOfForm, ReadsALifterOfKnownDepth) {
  for (const int frames : {1, 60, 5000}) {
    Lifter lifter = ConstantLifter(1.7, 0.0, GetParam());
    const TrapSigns signs = MeasureTrapSigns(*lifter, AnyViews(frames), 0, torch::kCPU);
    EXPECT_NEAR(signs.depth_ratio, 1.7, 1e-5) << frames;
    EXPECT_NEAR(signs.angle_deg, 0.0, 1e-3) << frames;
  }
  // Turned by 90 degrees, width and depth change places.
  Lifter turned = ConstantLifter(1.7, 90.0, GetParam());
  EXPECT_NEAR(MeasureTrapSigns(*turned, AnyViews(60), 0, torch::kCPU).depth_ratio, 1.0 / 1.7, 1e-5);
}

TEST(MeasureTrapSigns, MeasuresTheCamerasThemselvesNotThoseRotatedOntoThePerson) {
  // The output for the rotated input is constant while the rotation onto the root follows the person in the second
  // view: so it is the camera that swings by 10 degrees about its mean of 30, as the lifter sees it.
  TrainingSet set = AnyViews(60);
  for (int n = 0; n < 60; ++n) {
    set.turned_from_camera.emplace_back(Eigen::Matrix3f::Identity());
    set.turned_from_camera.emplace_back(
        TurnAbout(Eigen::Vector3d::UnitY(), n % 2 == 0 ? 20.0 : 40.0).transpose().cast<float>());
  }
  Lifter lifter = ConstantLifter(1.7, 0.0);
  const TrapSigns signs = MeasureTrapSigns(*lifter, set, 0, torch::kCPU);
  EXPECT_NEAR(signs.angle_deg, 40.0, 1e-3);  // of 20 and 40, the upper middle one
  EXPECT_NEAR(signs.scatter_deg, 10.0, 1e-3);
  EXPECT_NEAR(signs.depth_ratio, 1.7, 1e-5);
}

}  // namespace
}  // namespace canonpose
