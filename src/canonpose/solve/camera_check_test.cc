#include "canonpose/solve/camera_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(ShiftView, MovesOneViewOfOneClip) {
  const CaptureObservations before = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  ASSERT_GE(before.clips.size(), 2U);
  CaptureObservations after = before;
  ShiftView(after, 1, 2, 5);
  const ClipRange& clip = before.clips[1];
  for (int n = 0; n < before.frame_count; ++n) {
    for (int v = 0; v < before.view_count(); ++v) {
      for (int j = 0; j < before.joint_count(); ++j) {
        const bool moves = n >= clip.first && n < clip.first + clip.count && v == 2;
        if (moves && n < clip.first + 5) {
          EXPECT_FALSE(after.Sees(n, v, j));
          EXPECT_FALSE(after.HasStart(n, v));
          continue;
        }
        const int source = moves ? n - 5 : n;
        ASSERT_EQ(after.confidence[after.Index(n, v, j)], before.confidence[before.Index(source, v, j)]);
        if (!before.Sees(source, v, j)) continue;
        ASSERT_EQ(after.At(n, v, j), before.At(source, v, j));
      }
    }
  }
}

TEST(CheckCameras, LeavesGoodCamerasAlone) {
  CaptureObservations capture = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  const CaptureObservations before = capture;
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), solution);
  for (const std::vector<int>& offsets : check.offsets) EXPECT_THAT(offsets, Each(0));
  EXPECT_THAT(check.dropped, Each(false));
  EXPECT_EQ(capture.confidence, before.confidence);
}

TEST(CheckCameras, FindsADelayInOneClip) {
  SimulationOptions options = testing::SmallSimulation();
  options.seconds = 12.0;
  CaptureObservations capture = Observe(testing::Simulate(options).dataset);
  ShiftView(capture, 0, 1, 5);
  Solution solution = Quickly()(capture);
  const CameraCheck check = CheckCameras(capture, Quickly(), solution);
  EXPECT_THAT(check.offsets[0], ElementsAre(0, -5, 0, 0));
  EXPECT_THAT(check.offsets[1], Each(0));
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
  const CameraCheck check = CheckCameras(capture, Quickly(), solution);
  EXPECT_THAT(check.dropped, ElementsAre(false, false, true, false));
  EXPECT_FALSE(solution.estimate.CameraAt(0, 2).valid);
  EXPECT_LT(MedianError(capture, solution), 0.006);
}

}  // namespace
}  // namespace canonpose
