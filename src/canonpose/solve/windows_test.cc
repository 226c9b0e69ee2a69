#include "canonpose/solve/windows.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using ::testing::IsEmpty;
using testing::MakeExactRig;
using ::testing::SizeIs;

ExactRig TwoClips(bool static_cameras, int frames = 60) {
  ExactRigOptions options;
  options.static_cameras = static_cameras;
  options.clips = static_cameras ? 2 : 1;
  options.frames = frames;
  options.turn_rad_per_s = 0.0;
  return MakeExactRig(options);
}

Solution SolutionOf(const ExactRig& rig) {
  Solution solution;
  solution.estimate = rig.truth;
  return solution;
}

void MoveJoints(double scatter, Solution& solution, int root) {
  Rng rng(4);
  for (int n = 0; n < solution.estimate.frame_count(); ++n) {
    for (int j = 0; j < solution.estimate.joint_count; ++j) {
      if (!solution.estimate.static_cameras && j == root) continue;
      for (double& axis : solution.estimate.Joint(n, j)) axis += scatter * rng.Normal();
    }
  }
}

double LargestJointError(const RigEstimate& a, const RigEstimate& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    const double error = (a.joints[i] - b.joints[i]).norm();
    largest = std::isnan(error) ? std::numeric_limits<double>::infinity() : std::max(largest, error);
  }
  return largest;
}

class Windows : public ::testing::TestWithParam<bool> {};

TEST_P(Windows, BringEveryFrameOfEveryClipBackToTheTruth) {
  const ExactRig rig = TwoClips(GetParam());
  Solution solution = SolutionOf(rig);
  MoveJoints(0.01, solution, rig.capture.skeleton.root);
  ASSERT_GT(LargestJointError(solution.estimate, rig.truth), 0.02);
  const WindowsSummary summary = SolveWindows(rig.capture, 20, 1, solution);
  EXPECT_EQ(summary.windows, GetParam() ? 6 : 3);
  EXPECT_EQ(summary.converged + summary.stopped_early, summary.windows);
  EXPECT_THAT(summary.failed, IsEmpty());
  EXPECT_GE(summary.iterations, summary.windows);
  EXPECT_LT(summary.final_cost, 0.01 * summary.initial_cost);
  EXPECT_LT(LargestJointError(solution.estimate, rig.truth), 5e-3);
}

TEST_P(Windows, DoNotDependOnTheNumberOfThreads) {
  const ExactRig rig = TwoClips(GetParam());
  Solution one = SolutionOf(rig);
  MoveJoints(0.01, one, rig.capture.skeleton.root);
  Solution three = one;
  EXPECT_THAT(SolveWindows(rig.capture, 20, 1, one).failed, IsEmpty());
  EXPECT_THAT(SolveWindows(rig.capture, 20, 3, three).failed, IsEmpty());
  EXPECT_EQ(one.estimate.joints, three.estimate.joints);
}

/// A joint that is so far away that its bone has no length: nothing that an adjustment can start from.
constexpr double kNowhere = 1e200;

TEST_P(Windows, AFailureCostsItsOwnFramesAlone) {
  const ExactRig rig = TwoClips(GetParam(), 180);
  Solution solution = SolutionOf(rig);
  MoveJoints(0.01, solution, rig.capture.skeleton.root);
  const int clip_begin = rig.capture.clips.back().first;
  solution.estimate.Joint(clip_begin + 90, 5).setConstant(kNowhere);
  const WindowsSummary summary = SolveWindows(rig.capture, 60, 1, solution);
  ASSERT_THAT(summary.failed, SizeIs(1));
  EXPECT_EQ(summary.failed[0].clip, GetParam() ? 1 : 0);
  EXPECT_EQ(summary.failed[0].first_frame, 60);
  EXPECT_EQ(summary.failed[0].frame_count, 60);
  EXPECT_FALSE(summary.failed[0].reason.empty());
  EXPECT_FALSE(summary.AllFailed());
  EXPECT_EQ(summary.converged + summary.stopped_early, summary.windows - 1);
  EXPECT_TRUE(std::isfinite(summary.final_cost));
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    const bool has_failed = n >= clip_begin + 60 && n < clip_begin + 120;
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      ASSERT_EQ(solution.estimate.Joint(n, j).allFinite(), !has_failed) << n;
    }
    ASSERT_EQ(solution.estimate.CameraAt(n, 0).valid, GetParam() || !has_failed) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Solve, Windows, ::testing::Values(true, false),
                         [](const auto& instance) { return instance.param ? "Static" : "Moving"; });

TEST(SolveWindows, CountsWindowsWithAJointOnly) {
  const ExactRig rig = TwoClips(true);
  Solution solution = SolutionOf(rig);
  for (int n = 20; n < 40; ++n) {
    for (int j = 0; j < rig.capture.joint_count(); ++j) solution.estimate.Joint(n, j).setConstant(std::nan(""));
  }
  const WindowsSummary summary = SolveWindows(rig.capture, 20, 1, solution);
  EXPECT_EQ(summary.windows, 5);
  EXPECT_THAT(summary.failed, IsEmpty());
  EXPECT_FALSE(solution.estimate.Joint(30, 0).allFinite());
  EXPECT_TRUE(solution.estimate.Joint(19, 0).allFinite());
}

TEST(SolveWindows, KeepsTheWorldOfMovingCameras) {
  const ExactRig rig = TwoClips(false);
  Solution solution = SolutionOf(rig);
  MoveJoints(0.01, solution, rig.capture.skeleton.root);
  EXPECT_THAT(SolveWindows(rig.capture, 20, 1, solution).failed, IsEmpty());
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    for (int v = 0; v < rig.capture.view_count(); ++v) {
      const Eigen::Matrix3d change =
          solution.estimate.CameraAt(n, v).Rotation() * rig.truth.CameraAt(n, v).Rotation().transpose();
      ASSERT_LT(Eigen::AngleAxisd(change).angle(), 0.02) << n << ' ' << v;
    }
  }
}

TEST(WindowsSummary, RemembersWhatFailedInAnEarlierPass) {
  WindowsSummary summary;
  summary.windows = 2;
  summary.converged = 1;
  summary.failed = {{1, 0, 10, "second"}};
  summary.AddFailed({{0, 20, 10, "first"}});
  EXPECT_EQ(summary.windows, 3);
  ASSERT_THAT(summary.failed, SizeIs(2));
  EXPECT_EQ(summary.failed[0].reason, "first");
  EXPECT_FALSE(summary.AllFailed());
  summary.failed.push_back({2, 0, 10, "third"});
  EXPECT_TRUE(summary.AllFailed());
  EXPECT_FALSE(WindowsSummary{}.AllFailed());
}

}  // namespace
}  // namespace canonpose
