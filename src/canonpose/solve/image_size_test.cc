#include "canonpose/solve/image_size.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/calibration.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose {
namespace {

CaptureObservations Observe(const Dataset& dataset) {
  return CollectCaptures(dataset, testing::NoisyTruth(dataset)).front();
}

Solution Calibrated(const CaptureObservations& capture) {
  CalibrationOptions options;
  options.mirror = "keep";
  options.frames = 120;
  return CalibrateStatic(capture, options);
}

std::vector<std::array<int, 2>> SizesAfterCorrection(CaptureObservations capture) {
  Solution solution = Calibrated(capture);
  CorrectImageSizes(capture, Calibrated, Calibrated, solution);
  std::vector<std::array<int, 2>> sizes;
  for (const ObservedCamera& camera : capture.cameras) sizes.push_back(camera.image_size_px);
  return sizes;
}

TEST(ImageSize, KeepsPixels) {
  const CaptureObservations before = Observe(testing::Simulate(testing::SmallSimulation()).dataset);
  CaptureObservations after = before;
  SetImageSize(after, 1, {700, 300});
  const auto pixel = [](const CaptureObservations& capture) {
    const ObservedCamera& camera = capture.cameras[1];
    int n = 0;
    while (!capture.Sees(n, 1, 0)) ++n;
    return Eigen::Vector2d(capture.At(n, 1, 0) * camera.diagonal_px +
                           0.5 * Eigen::Vector2d(camera.image_size_px[0], camera.image_size_px[1]));
  };
  EXPECT_LT((pixel(after) - pixel(before)).norm(), 1e-3);
  EXPECT_EQ(after.cameras[1].declared_size_px, before.cameras[1].image_size_px);
}

TEST(ImageSize, LeavesRightSizesAlone) {
  const Dataset dataset = testing::Simulate(testing::SmallSimulation()).dataset;
  for (const std::array<int, 2>& size : SizesAfterCorrection(Observe(dataset))) {
    EXPECT_EQ(size, dataset.sequences.front().cameras.front().image_size);
  }
}

TEST(ImageSize, FindsOneViewOfAScaledVideoAndAllViewsOfOne) {
  for (const bool is_everywhere : {false, true}) {
    Dataset dataset = testing::Simulate(testing::SmallSimulation()).dataset;
    std::vector<std::array<int, 2>> expected;
    for (std::size_t v = 0; v < dataset.sequences.front().cameras.size(); ++v) {
      expected.push_back(dataset.sequences.front().cameras[v].image_size);
      if (v != 2 && !is_everywhere) continue;
      for (int& length : expected.back()) length /= 2;
      for (Sequence& sequence : dataset.sequences) {
        for (float& pixel : sequence.cameras[v].keypoints) pixel *= 0.5F;
      }
    }
    EXPECT_EQ(SizesAfterCorrection(Observe(dataset)), expected) << is_everywhere;
  }
}

}  // namespace
}  // namespace canonpose
