#include "canonpose/train/batch_order.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "canonpose/train/losses.h"

namespace canonpose {
namespace {

/// Frames of several sequences at 10 frames per second, of two captures in turn; two cameras.
TrainingSet Set(const std::vector<int>& lengths) {
  TrainingSet set;
  set.static_captures = {0, 0};
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    for (int t = 0; t < lengths[s]; ++t) {
      set.frames.push_back({static_cast<int>(s % 2), 0, {{0, 0}, {1, 0}}, static_cast<int>(s), 0.1 * t});
    }
  }
  return set;
}

std::vector<std::size_t> Sorted(std::vector<std::size_t> values) {
  std::sort(values.begin(), values.end());
  return values;
}

std::vector<std::size_t> FirstNumbers(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

TEST(WindowedOrder, HasEveryFrameOnceAndWindowsOfOneSequenceWithinTheirLength) {
  const TrainingSet set = Set({70, 5, 41});
  Rng rng(1);
  const EpochOrder order = WindowedOrder(set, 2.0, 8, rng);
  EXPECT_EQ(Sorted(order.frames), FirstNumbers(116));
  ASSERT_EQ(order.windows.size(), order.frames.size());
  std::map<std::int64_t, std::vector<const TrainingFrame*>> windows;
  for (std::size_t i = 0; i < order.frames.size(); ++i) {
    windows[order.windows[i]].push_back(&set.frames[order.frames[i]]);
  }
  EXPECT_GE(windows.size(), 4U + 1U + 3U);
  EXPECT_LE(windows.size(), 5U + 2U + 4U);
  for (const auto& [window, frames] : windows) {
    const auto [first, last] = std::minmax_element(
        frames.begin(), frames.end(), [](const auto* a, const auto* b) { return a->seconds < b->seconds; });
    EXPECT_LT((*last)->seconds - (*first)->seconds, 2.0 + 1e-9);
    for (const TrainingFrame* frame : frames) EXPECT_EQ(frame->sequence, frames.front()->sequence);
  }
}

TEST(WindowedOrder, RunsOfAWindowComeTogetherButNotInTheirOrder) {
  const TrainingSet set = Set({400, 400});
  Rng rng(1);
  const EpochOrder order = WindowedOrder(set, 2.0, 8, rng);
  int changes = 0;
  int backwards = 0;
  for (std::size_t i = 1; i < order.frames.size(); ++i) {
    changes += order.windows[i] != order.windows[i - 1] ? 1 : 0;
    backwards += order.frames[i] < order.frames[i - 1] ? 1 : 0;
  }
  EXPECT_GT(changes, 60);  // 40 windows of 20 frames: runs of 8, 8 and 4
  EXPECT_LT(changes, 130);
  EXPECT_GT(backwards, 300);
}

TEST(WindowedOrder, CameraPairsStayInTheWindow) {
  const TrainingSet set = Set({60, 60, 60});
  Rng rng(2);
  const EpochOrder order = WindowedOrder(set, 1.5, 8, rng);
  std::vector<const TrainingFrame*> frames;
  for (std::size_t i = 0; i < 32; ++i) frames.push_back(&set.frames[order.frames[i]]);
  const std::vector<std::int64_t> windows(order.windows.begin(), order.windows.begin() + 32);
  const PairList pairs =
      MakeBatchPairs(
          frames, set.static_captures, true, [&](std::size_t count) { return rng.Permutation(count); }, windows)
          .camera;
  ASSERT_EQ(pairs.size(), 32U * 2U);  // every frame gets a rotation, its own by chance
  int own = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const auto frame = static_cast<std::size_t>(pairs.source[p] / 2);
    const auto lender = static_cast<std::size_t>(pairs.from[p] / 2);
    EXPECT_EQ(windows[frame], windows[lender]);
    EXPECT_EQ(frames[frame]->sequence, frames[lender]->sequence);
    EXPECT_LT(std::abs(frames[frame]->seconds - frames[lender]->seconds), 1.5);
    own += frame == lender ? 1 : 0;
  }
  EXPECT_LT(own, 32);
  // Two captures, two source cameras each: a sum of means, however many windows they come from.
  EXPECT_NEAR(std::accumulate(pairs.weight.begin(), pairs.weight.end(), 0.0), 4.0, 1e-12);
}

TEST(WindowFactor, FallsLinearlyToZeroAndIsZeroWithoutWindows) {
  TrainOptions options;
  const Schedule schedule{10, 100};
  EXPECT_EQ(WindowFactor(options, schedule, 0), 0.0);
  options.camera_consistency = CameraConsistency::kWindow;
  options.camera_window_end = 0.5;
  EXPECT_EQ(WindowFactor(options, schedule, 0), 1.0);
  EXPECT_NEAR(WindowFactor(options, schedule, 125), 0.75, 1e-12);
  EXPECT_EQ(WindowFactor(options, schedule, 500), 0.0);
  EXPECT_EQ(WindowFactor(options, schedule, 900), 0.0);
}

TEST(Batches, DependOnSeedAndStepAlone) {
  const TrainingSet set = Set({50, 30});
  TrainOptions options;
  options.batch_frames = 16;
  for (const CameraConsistency consistency : {CameraConsistency::kOff, CameraConsistency::kWindow}) {
    options.camera_consistency = consistency;
    const Schedule schedule{4, 5};
    Batches batches(set, options, schedule);
    const Batch wanted = batches.At(7, 1);
    EXPECT_EQ(wanted.windows.size(), consistency == CameraConsistency::kWindow ? 16U : 0U);
    EXPECT_NE(batches.At(7, 2).frames, wanted.frames);
    EXPECT_NE(batches.At(12, 1).frames, wanted.frames);
    EXPECT_EQ(batches.At(7, 1).frames, wanted.frames);
    EXPECT_EQ(Batches(set, options, schedule).At(7, 1).windows, wanted.windows);
    // The windows are gone in the second half.
    EXPECT_TRUE(batches.At(17, 1).windows.empty());
    std::vector<const TrainingFrame*> epoch;
    for (int step = 0; step < 5; ++step) {
      for (const TrainingFrame* frame : batches.At(step, 1).frames) epoch.push_back(frame);
    }
    std::sort(epoch.begin(), epoch.end());
    EXPECT_EQ(std::unique(epoch.begin(), epoch.end()) - epoch.begin(), 80);
  }
}

}  // namespace
}  // namespace canonpose
