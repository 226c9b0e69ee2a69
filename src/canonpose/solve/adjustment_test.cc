#include "canonpose/solve/adjustment.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using ::testing::HasSubstr;
using testing::MakeExactRig;
using ::testing::Not;

ExactRig Rig(bool static_cameras) {
  ExactRigOptions options;
  options.static_cameras = static_cameras;
  options.frames = 20;
  return MakeExactRig(options);
}

/// Terms that exact data does not satisfy say next to nothing; the first of the static cameras is the world.
AdjustmentOptions ForExactData() {
  AdjustmentOptions options;
  options.scales.angular_velocity = 1e4;
  options.scales.angular_acceleration = 1e4;
  options.scales.zoom_per_second = 1e4;
  options.iterations = 100;
  options.fixed_view = 0;
  return options;
}

std::vector<int> AllFrames(const ExactRig& rig) { return ConsecutiveFrames(0, rig.capture.frame_count); }

AdjustmentSummary AdjustAll(const ExactRig& rig, const AdjustmentOptions& options, RigEstimate& estimate) {
  return Adjust(rig.capture, AllFrames(rig), options, estimate);
}

/// Largest distance between projections of two estimates, normalised image coordinates.
double LargestReprojection(const RigEstimate& a, const RigEstimate& b) {
  double largest = 0.0;
  for (int n = 0; n < a.frame_count(); ++n) {
    for (int v = 0; v < a.view_count; ++v) {
      for (int j = 0; j < a.joint_count; ++j) {
        largest = std::max(largest, (a.Project(n, v, j) - b.Project(n, v, j)).norm());
      }
    }
  }
  return largest;
}

double LargestJointError(const RigEstimate& a, const RigEstimate& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.joints.size(); ++i) largest = std::max(largest, (a.joints[i] - b.joints[i]).norm());
  return largest;
}

double SumOfBones(const RigEstimate& estimate) {
  double sum = 0.0;
  for (const double length : estimate.log_bone_lengths[0]) sum += std::isfinite(length) ? std::exp(length) : 0.0;
  return sum;
}

/// Cameras but the first, joints and bones off by some per cent.
RigEstimate Perturbed(const RigEstimate& truth, int root) {
  Rng rng(3);
  const auto random = [&rng](double size) {
    return Eigen::Vector3d(size * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()));
  };
  RigEstimate estimate = truth;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    if (estimate.static_cameras && c == 0) continue;
    CameraEstimate& camera = estimate.cameras[c];
    const Eigen::Vector3d turn = random(0.03);
    camera.SetRotation(Eigen::AngleAxisd(turn.norm(), turn.normalized()) * camera.Rotation());
    const Eigen::Vector3d shift = random(0.02);
    for (std::size_t axis = 0; axis < 3; ++axis) camera.placement[axis] += shift[static_cast<Eigen::Index>(axis)];
    camera.log_focal += 0.02 * rng.Normal();
  }
  for (int n = 0; n < truth.frame_count(); ++n) {
    for (int j = 0; j < truth.joint_count; ++j) {
      if (truth.static_cameras || j != root) estimate.Joint(n, j) += random(0.02);
    }
  }
  for (double& length : estimate.log_bone_lengths[0]) length += 0.05 * rng.Normal();
  return estimate;
}

class Rigs : public ::testing::TestWithParam<bool> {};

TEST_P(Rigs, ExactDataStaysExact) {
  const ExactRig rig = Rig(GetParam());
  RigEstimate estimate = rig.truth;
  const AdjustmentSummary summary = AdjustAll(rig, ForExactData(), estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kConverged) << summary.reason;
  EXPECT_LT(summary.final_cost, 1e-4);
  EXPECT_LT(LargestReprojection(estimate, rig.truth), 1e-5);
  EXPECT_LT(LargestJointError(estimate, rig.truth), 1e-4);
}

TEST_P(Rigs, APerturbedStartReturnsToTheTruth) {
  const ExactRig rig = Rig(GetParam());
  RigEstimate estimate = Perturbed(rig.truth, rig.capture.skeleton.root);
  ASSERT_GT(LargestReprojection(estimate, rig.truth), 0.05);
  const AdjustmentSummary summary = AdjustAll(rig, ForExactData(), estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kConverged) << summary.reason;
  // The image scales of moving cameras are drawn, weakly, to what they were at the perturbed start.
  EXPECT_LT(summary.final_cost, (GetParam() ? 1e-6 : 1e-5) * summary.initial_cost);
  EXPECT_LT(LargestReprojection(estimate, rig.truth), 1e-4);
  for (std::size_t j = 1; j < estimate.log_bone_lengths[0].size(); ++j) {
    EXPECT_NEAR(estimate.log_bone_lengths[0][j], rig.truth.log_bone_lengths[0][j], 1e-3) << j;
  }
  // Static: the first camera is where it was, so that everything is. Moving: the world of a frame may turn.
  const bool world_is_fixed = GetParam();
  EXPECT_TRUE(!world_is_fixed || LargestJointError(estimate, rig.truth) < 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Adjust, Rigs, ::testing::Values(true, false),
                         [](const auto& instance) { return instance.param ? "Static" : "Moving"; });

/// The same rig in a world that is turned, moved and of another size.
RigEstimate InAnotherWorld(const RigEstimate& estimate, double size) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(0.3, -0.2, 0.4);
  RigEstimate other = estimate;
  for (Eigen::Vector3d& joint : other.joints) joint = size * (turn * joint) + shift;
  for (CameraEstimate& camera : other.cameras) {
    const Eigen::Matrix3d rotation = camera.Rotation() * turn.transpose();
    camera.SetRotation(rotation);
    auto translation = Eigen::Vector3d::Map(camera.placement.data());
    translation = (size * translation - rotation * shift).eval();
  }
  for (double& length : other.log_bone_lengths[0]) length += std::log(size);
  return other;
}

TEST(Adjust, TheWorldMayBeTurnedMovedAndOfAnySize) {
  const ExactRig rig = Rig(true);
  AdjustmentOptions options = ForExactData();
  options.fixed_view = -1;
  RigEstimate here = Perturbed(rig.truth, rig.capture.skeleton.root);
  RigEstimate there = InAnotherWorld(here, 1.0);
  ASSERT_LT(LargestReprojection(here, there), 1e-9);
  const AdjustmentSummary summary_here = AdjustAll(rig, options, here);
  const AdjustmentSummary summary_there = AdjustAll(rig, options, there);
  EXPECT_NEAR(summary_there.initial_cost, summary_here.initial_cost, 1e-6 * summary_here.initial_cost);
  EXPECT_LT(LargestReprojection(here, there), 1e-4);
  EXPECT_GT(LargestJointError(here, there), 0.1);  // it stays where it was: nothing says where the world is

  RigEstimate large = InAnotherWorld(rig.truth, 1.1);
  ASSERT_NEAR(SumOfBones(large), 1.1, 1e-9);
  const AdjustmentSummary of_large = AdjustAll(rig, options, large);
  EXPECT_EQ(of_large.ending, AdjustmentEnding::kConverged) << of_large.reason;
  EXPECT_LT(of_large.final_cost, 1e-6 * of_large.initial_cost);
  EXPECT_NEAR(SumOfBones(large), 1.0, 1e-3);
  EXPECT_LT(LargestReprojection(here, large), 1e-4);
}

TEST(Adjust, StopsEarlyAtTheIterationLimit) {
  const ExactRig rig = Rig(true);
  AdjustmentOptions options = ForExactData();
  options.iterations = 1;
  RigEstimate estimate = Perturbed(rig.truth, rig.capture.skeleton.root);
  const AdjustmentSummary summary = AdjustAll(rig, options, estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kIterationLimit);
  EXPECT_TRUE(summary.IsUsable());
  EXPECT_EQ(summary.iterations, 1);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_THAT(summary.reason, HasSubstr("iterations"));
}

TEST(Adjust, SaysWhenItConverged) {
  const ExactRig rig = Rig(true);
  RigEstimate estimate = Perturbed(rig.truth, rig.capture.skeleton.root);
  const AdjustmentSummary summary = AdjustAll(rig, ForExactData(), estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kConverged);
  EXPECT_THAT(summary.reason, HasSubstr("tolerance reached"));
  EXPECT_GT(summary.iterations, 2);
  EXPECT_LT(summary.iterations, 100);
}

TEST(Adjust, ReportsAFailureAndLeavesTheEstimateAlone) {
  const ExactRig rig = Rig(false);
  RigEstimate estimate = rig.truth;
  estimate.CameraAt(5, 1).placement[2] = 100.0;  // an image scale that no camera has
  const std::vector<Eigen::Vector3d> before = estimate.joints;
  const AdjustmentSummary summary = AdjustAll(rig, ForExactData(), estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kFailed);
  EXPECT_FALSE(summary.IsUsable());
  EXPECT_THAT(summary.reason, HasSubstr("failed"));
  EXPECT_THAT(summary.reason, Not(HasSubstr("\n")));
  EXPECT_TRUE(std::isnan(summary.final_cost));
  EXPECT_EQ(estimate.joints, before);
}

TEST(Adjust, FailsWithoutAnythingToAdjust) {
  const ExactRig rig = Rig(true);
  RigEstimate estimate = rig.truth;
  for (CameraEstimate& camera : estimate.cameras) camera.valid = false;
  const AdjustmentSummary summary = AdjustAll(rig, ForExactData(), estimate);
  EXPECT_EQ(summary.ending, AdjustmentEnding::kFailed);
  EXPECT_THAT(summary.reason, HasSubstr("no camera"));
  EXPECT_TRUE(std::isnan(summary.initial_cost));
}

TEST(Adjust, UnknownJointsAndCamerasTakeNoPart) {
  const ExactRig rig = Rig(true);
  RigEstimate estimate = Perturbed(rig.truth, rig.capture.skeleton.root);
  estimate.CameraAt(0, 3).valid = false;
  const std::array<double, 3> placement = estimate.CameraAt(0, 3).placement;
  estimate.Joint(4, 6).setConstant(std::nan(""));
  EXPECT_TRUE(AdjustAll(rig, ForExactData(), estimate).IsUsable());
  EXPECT_FALSE(estimate.Joint(4, 6).allFinite());
  EXPECT_EQ(estimate.CameraAt(0, 3).placement, placement);
  EXPECT_LT((estimate.Joint(5, 6) - rig.truth.Joint(5, 6)).norm(), 1e-3);
}

TEST(RunsOf, EndAtGapsAndClips) {
  ExactRigOptions options;
  options.clips = 2;
  options.frames = 10;
  const ExactRig rig = MakeExactRig(options);
  EXPECT_THAT(RunsOf(rig.capture, std::vector<int>{0, 1, 3, 4, 9, 10, 11}),
              ::testing::ElementsAre(0, 0, 1, 1, 2, 3, 3));
}

TEST(AdjustmentEnding, HasANameForReports) {
  EXPECT_STREQ(NameOf(AdjustmentEnding::kConverged), "converged");
  EXPECT_STREQ(NameOf(AdjustmentEnding::kIterationLimit), "stopped early");
  EXPECT_STREQ(NameOf(AdjustmentEnding::kFailed), "failed");
}

}  // namespace
}  // namespace canonpose
