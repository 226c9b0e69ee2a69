#include "canonpose/solve/swaps.h"

#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/calibration.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/windows.h"

namespace canonpose {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(CheapestPath, IsTheBestOfAllPaths) {
  constexpr int kFrames = 6;
  constexpr int kStates = 3;
  Rng rng(1);
  std::vector<double> costs;
  for (int i = 0; i < kFrames * kStates; ++i) costs.push_back(rng.Uniform());
  const auto cost = [&](int n, int s) { return costs[static_cast<std::size_t>(n * kStates + s)]; };
  const auto change = [](int n, int a, int b) { return 0.1 * n * std::abs(a - b); };
  const auto total = [&](const std::vector<int>& path) {
    double sum = 0.0;
    for (int n = 0; n < kFrames; ++n) {
      const auto i = static_cast<std::size_t>(n);
      sum += cost(n, path[i]) + (n > 0 ? change(n, path[i - 1], path[i]) : 0.0);
    }
    return sum;
  };
  double least = std::numeric_limits<double>::infinity();
  for (int code = 0; code < 729; ++code) {  // 3^6
    std::vector<int> path;
    for (int n = 0, rest = code; n < kFrames; ++n, rest /= kStates) path.push_back(rest % kStates);
    least = std::min(least, total(path));
  }
  EXPECT_DOUBLE_EQ(total(CheapestPath(kFrames, kStates, cost, change)), least);
  EXPECT_THAT(CheapestPath(0, kStates, cost, change), IsEmpty());
}

TEST(FindSwapParts, OfAllBuiltinSkeletons) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    const SwapParts parts = FindSwapParts(skeleton);
    EXPECT_GE(parts.legs.size(), 3U) << skeleton.name;
    EXPECT_THAT(parts.arms, SizeIs(3)) << skeleton.name;
    std::size_t paired = 0;
    for (int j = 0; j < skeleton.joint_count(); ++j) paired += skeleton.mirror[static_cast<std::size_t>(j)] > j ? 1 : 0;
    EXPECT_EQ(parts.legs.size() + parts.arms.size() + parts.rest.size(), paired) << skeleton.name;
    for (const auto& [a, b] : parts.arms) {
      EXPECT_EQ(skeleton.mirror[static_cast<std::size_t>(a)], b);
    }
  }
}

struct Solved {
  CaptureObservations capture;
  Solution solution;
};

Solved SolveSmall(const testing::SimulatedCapture& simulated) {
  Solved solved;
  solved.capture = CollectCaptures(simulated.dataset, testing::NoisyTruth(simulated.dataset)).front();
  CaptureObservations& capture = solved.capture;
  CalibrationOptions options;
  options.mirror = "keep";
  options.frames = 150;
  solved.solution = CalibrateStatic(capture, options);
  return solved;
}

/// Keypoints (of a frame, a view and a joint with a partner) that the simulated detector swapped, and those of them,
/// and of the others, that were exchanged.
struct Count {
  int swapped = 0;
  int found = 0;
  int falsely = 0;
};

Count CountSwaps(const testing::SimulatedCapture& simulated, const CaptureObservations& before,
                 const CaptureObservations& after) {
  Count count;
  for (const ClipRange& clip : after.clips) {
    for (int v = 0; v < after.view_count(); ++v) {
      const Detections& detections = simulated.detections[clip.sequence][static_cast<std::size_t>(v)];
      for (int t = 0; t < clip.count; ++t) {
        for (int j = 0; j < after.joint_count(); ++j) {
          const int n = clip.first + t;
          if (after.skeleton.mirror[static_cast<std::size_t>(j)] == j) continue;
          if (!before.Sees(n, v, j) || !after.Sees(n, v, j)) continue;
          const bool is_swapped =
              (detections.errors[static_cast<std::size_t>(t * after.joint_count() + j)] & kSwapped) != 0;
          const bool is_exchanged = before.At(n, v, j) != after.At(n, v, j);
          count.swapped += is_swapped ? 1 : 0;
          count.found += is_swapped && is_exchanged ? 1 : 0;
          count.falsely += !is_swapped && is_exchanged ? 1 : 0;
        }
      }
    }
  }
  return count;
}

TEST(CorrectSwaps, FindsMostAndInventsFew) {
  SimulationOptions options = testing::SmallSimulation();
  options.detector.swaps = 4.0;
  const testing::SimulatedCapture simulated = testing::Simulate(options);
  Solved solved = SolveSmall(simulated);
  const CaptureObservations before = solved.capture;
  EXPECT_GT(CorrectSwaps(solved.capture, solved.solution, 1), 0);
  const Count count = CountSwaps(simulated, before, solved.capture);
  ASSERT_GT(count.swapped, 100);
  EXPECT_GT(count.found, 0.9 * count.swapped);
  EXPECT_LT(count.falsely, 0.1 * count.swapped);
}

TEST(CorrectSwaps, LeavesExactKeypointsAlone) {
  SimulationOptions options = testing::SmallSimulation();
  options.detector.noise = 0.0;
  Solved solved = SolveSmall(testing::Simulate(options));
  EXPECT_EQ(CorrectSwaps(solved.capture, solved.solution, 1), 0);
}

TEST(CorrectSwaps, DoesNotDependOnThreads) {
  SimulationOptions options = testing::SmallSimulation();
  options.detector.swaps = 4.0;
  options.clips = 1;
  Solved solved = SolveSmall(testing::Simulate(options));
  CaptureObservations other = solved.capture;
  EXPECT_EQ(CorrectSwaps(solved.capture, solved.solution, 1), CorrectSwaps(other, solved.solution, 3));
  EXPECT_EQ(solved.capture.confidence, other.confidence);
}

}  // namespace
}  // namespace canonpose
