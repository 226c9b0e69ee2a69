#include "canonpose/solve/clock_refinement.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using testing::MakeExactRig;
using testing::SeeJoints;
using testing::TakeFrames;

/// Every fifth frame of a rig of 125 frames per second, and of one view others: those `late` earlier, plus `drift` for
/// every frame after the middle.
struct LateView {
  ExactRig rig;
  Solution solution;

  LateView(bool static_cameras, int late, int drift, double noise) {
    ExactRigOptions options;
    options.static_cameras = static_cameras;
    options.frames = 5 * kFrames;
    options.fps = 125.0;
    options.turn_rad_per_s = 0.2;
    ExactRig fine = MakeExactRig(options);
    SeeJoints(fine.truth, noise, 1, fine.capture);
    options.frames = kFrames;
    options.fps = 25.0;
    rig = MakeExactRig(options);
    for (int v = 0; v < rig.capture.view_count(); ++v) {
      for (int n = 0; n < kFrames; ++n) {
        rig.truth.CameraAt(n, v) = fine.truth.CameraAt(5 * n, v);
        const bool is_late = v == kLate;
        const int from = 5 * n - (is_late ? late + drift * (n - kFrames / 2) / 10 : 0);
        for (int j = 0; j < rig.capture.joint_count(); ++j) {
          testing::Hide(rig.capture, n, v, j);
          if (from < 0 || from >= fine.capture.frame_count) continue;
          const std::size_t to = rig.capture.Index(n, v, j);
          const std::size_t old = fine.capture.Index(from, v, j);
          rig.capture.confidence[to] = fine.capture.confidence[old];
          std::copy_n(&fine.capture.xy[2 * old], 2, &rig.capture.xy[2 * to]);
        }
      }
    }
    solution.estimate = rig.truth;
    solution.scales.observation = NoiseModel(std::max(noise, 0.001));
  }

  [[nodiscard]] std::vector<ClockStep> Steps() const {
    ClockStepOptions options;
    options.fixed = {true, false, false, false};
    options.drift_deviation = 0.1;
    return StepClocks(rig.capture, solution, 0, ConsecutiveFrames(0, kFrames), options);
  }

  static constexpr int kFrames = 100;
  static constexpr int kLate = 2;
};

TEST(StepClocks, FindsAFractionOfAFrame) {
  for (const bool is_static : {true, false}) {
    const std::vector<ClockStep> steps = LateView(is_static, 2, 0, 0.0005).Steps();
    ASSERT_EQ(steps.size(), 4U);
    EXPECT_FALSE(steps[0].known);
    for (std::size_t v = 1; v < 4; ++v) {
      ASSERT_TRUE(steps[v].known);
      // The view shows what the others showed 0.4 frames ago, so its time has to be made less by that.
      EXPECT_NEAR(steps[v].offset, v == LateView::kLate ? -0.4 : 0.0, 0.1) << v << (is_static ? " static" : " moving");
      EXPECT_NEAR(steps[v].drift, 0.0, 2e-3);
      EXPECT_LT(steps[v].offset_deviation, 0.1);
      EXPECT_GT(steps[v].offset_deviation, 0.0);
    }
  }
}

TEST(StepClocks, FindsADrift) {
  const std::vector<ClockStep> steps = LateView(true, 0, 1, 0.0).Steps();
  EXPECT_NEAR(steps[LateView::kLate].drift, -0.02, 6e-3);
  EXPECT_NEAR(steps[1].drift, 0.0, 4e-3);
}

TEST(StepClocks, TheDeviationGrowsWithTheNoise) {
  const double little = LateView(true, 0, 0, 0.001).Steps()[1].offset_deviation;
  const double much = LateView(true, 0, 0, 0.008).Steps()[1].offset_deviation;
  EXPECT_GT(much, 3.0 * little);
}

TEST(StepClocks, KnowsNothingOfAViewThatShowsNothing) {
  LateView late(true, 0, 0, 0.001);
  TakeFrames(
      late.rig.capture, 3, [](int) { return -1; }, late.rig.capture);
  const std::vector<ClockStep> steps = late.Steps();
  EXPECT_FALSE(steps[3].known);
  EXPECT_TRUE(steps[1].known);
}

}  // namespace
}  // namespace canonpose
