#include "canonpose/solve/camera_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

CaptureObservations Observe(const Dataset& dataset) {
  return CollectCaptures(dataset, testing::NoisyTruth(dataset)).front();
}

Calibrate Quickly() {
  return [](const CaptureObservations& capture) {
    CalibrationOptions options;
    options.mirror = "keep";
    options.frames = 150;
    return CalibrateStatic(capture, options);
  };
}

/// Frames by which a view is shifted.
class Shifts : public ::testing::TestWithParam<int> {};

TEST_P(Shifts, MoveOneViewOfOneClip) {
  const CaptureObservations before = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  ASSERT_GE(before.clips.size(), 2U);
  constexpr int kClip = 0;
  constexpr int kView = 2;
  CaptureObservations after = before;
  ShiftView(after, kClip, kView, GetParam());
  const ClipRange& clip = before.clips[kClip];
  const auto is_in_clip = [&](int n) { return n >= clip.first && n < clip.first + clip.count; };
  for (int n = 0; n < before.frame_count; ++n) {
    for (int v = 0; v < before.view_count(); ++v) {
      const bool moves = is_in_clip(n) && v == kView;
      const int source = moves ? n - GetParam() : n;
      if (moves && !is_in_clip(source)) {
        EXPECT_FALSE(after.HasStart(n, v));
        for (int j = 0; j < before.joint_count(); ++j) ASSERT_FALSE(after.Sees(n, v, j)) << n;
        continue;
      }
      ASSERT_EQ(after.HasStart(n, v), before.HasStart(source, v)) << n;
      if (before.HasStart(source, v)) {
        ASSERT_EQ(after.StartOf(n, v), before.StartOf(source, v)) << n;
      }
      for (int j = 0; j < before.joint_count(); ++j) {
        ASSERT_EQ(after.confidence[after.Index(n, v, j)], before.confidence[before.Index(source, v, j)]) << n;
        if (!before.Sees(source, v, j)) continue;
        ASSERT_EQ(after.At(n, v, j), before.At(source, v, j)) << n;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Shifts, ::testing::Values(5, -5, 0, 149, 1000, -1000));

TEST(CheckCameras, LeavesGoodCamerasAlone) {
  CaptureObservations capture = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  const CaptureObservations before = capture;
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), Quickly(), solution);
  for (const std::vector<ViewCorrection>& corrections : check.corrections) {
    for (const ViewCorrection& correction : corrections) EXPECT_TRUE(correction.IsNone());
  }
  EXPECT_THAT(check.dropped, Each(false));
  EXPECT_EQ(capture.confidence, before.confidence);
}

TEST(CheckCameras, FindsADelayInOneClip) {
  SimulationOptions options = testing::SmallSimulation();
  options.seconds = 12.0;
  CaptureObservations capture = Observe(testing::Simulate(options).dataset);
  ShiftView(capture, 0, 1, 5);
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), Quickly(), solution);
  for (int v = 0; v < capture.view_count(); ++v) {
    EXPECT_EQ(check.At(0, v).TimeOf(0), v == 1 ? -5.0 : 0.0);
    EXPECT_EQ(check.At(1, v).TimeOf(0), 0.0);
  }
  EXPECT_THAT(check.dropped, Each(false));
  EXPECT_LT(MedianError(capture, solution), 0.006);
}

TEST(CheckCameras, DropsACameraThatShowsSomebodyElse) {
  testing::SimulatedCapture simulated = testing::Simulate(testing::SmallSimulation());
  SimulationOptions others = testing::SmallSimulation();
  others.seed = 77;
  others.activities = {Activity::kSquat, Activity::kThrow};
  const Dataset strangers = testing::Simulate(others).dataset;
  for (std::size_t s = 0; s < strangers.sequences.size(); ++s) {
    simulated.dataset.sequences[s].cameras[2] = strangers.sequences[s].cameras[2];
  }
  CaptureObservations capture = Observe(simulated.dataset);
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), Quickly(), solution);
  EXPECT_THAT(check.dropped, ElementsAre(false, false, true, false));
  EXPECT_FALSE(solution.estimate.CameraAt(0, 2).valid);
  EXPECT_LT(MedianError(capture, solution), 0.006);
}

TEST(CheckCameras, ReadsAMirroredCameraAsItShouldBe) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  CaptureObservations capture = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  const CaptureObservations before = capture;
  ViewCorrection mirror;
  mirror.reading.is_mirrored = mirror.reading.sides_are_exchanged = true;
  for (int clip = 0; clip < 2; ++clip) ApplyCorrection(mirror, clip, 2, capture);
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), Quickly(), solution);
  for (int clip = 0; clip < 2; ++clip) {
    EXPECT_TRUE(check.At(clip, 2).reading.is_mirrored);
    EXPECT_THAT(check.At(clip, 2).bad, ::testing::IsEmpty());
  }
  EXPECT_THAT(check.dropped, Each(false));
  EXPECT_EQ(capture.confidence, before.confidence);
  for (std::size_t i = 0; i < before.xy.size(); ++i) {
    if (before.confidence[i / 2] > 0.0F) {
      ASSERT_NEAR(capture.xy[i], before.xy[i], 1e-6) << i;
    }
  }
  EXPECT_LT(MedianError(capture, solution), 0.006);
}

// Views 0 and 2 stand opposite each other, and so do 1 and 3: no pair by itself shows depth.
TEST(CheckCameras, ReadsTwoOppositeCamerasOfHalfTheFrameRate) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = testing::SmallSimulation();
  options.seconds = 12.0;
  CaptureObservations capture = Observe(testing::Simulate(options).dataset);
  ViewCorrection slower;
  slower.reading.time.rate = 0.5;
  for (int clip = 0; clip < static_cast<int>(capture.clips.size()); ++clip) {
    for (const int view : {0, 2}) ApplyCorrection(slower, clip, view, capture);
  }
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), Quickly(), solution);
  EXPECT_THAT(check.dropped, Each(false));
  for (int clip = 0; clip < static_cast<int>(capture.clips.size()); ++clip) {
    for (int v = 0; v < 4; ++v) EXPECT_EQ(check.At(clip, v).reading.time.rate, v % 2 == 0 ? 2.0 : 1.0) << clip << v;
  }
  EXPECT_LT(MedianError(capture, solution), 0.006);
}

}  // namespace
}  // namespace canonpose
