#include "canonpose/train/batch_order.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/train/streams.h"

namespace canonpose {
namespace {

/// Frames of a window that come in one batch.
constexpr int kRunFrames = 8;

/// Frames that stay together in EpochOrder::frames.
struct Run {
  std::vector<std::size_t> frames;
  std::int64_t window = 0;
};

/// The frames of each window, by sequence and then time.
std::vector<std::vector<std::size_t>> CutIntoWindows(const TrainingSet& set, double window_seconds, Rng& rng) {
  std::map<int, double> starts;
  std::map<std::pair<int, std::int64_t>, std::vector<std::size_t>> windows;
  for (std::size_t n = 0; n < set.frames.size(); ++n) {
    const TrainingFrame& frame = set.frames[n];
    if (!starts.contains(frame.sequence)) starts[frame.sequence] = rng.Uniform();
    const double windows_before = std::floor(frame.seconds / window_seconds + starts[frame.sequence]);
    windows[{frame.sequence, static_cast<std::int64_t>(windows_before)}].push_back(n);
  }
  std::vector<std::vector<std::size_t>> cut;
  for (auto& [window, frames] : windows) cut.push_back(std::move(frames));
  return cut;
}

}  // namespace

EpochOrder ShuffledOrder(std::size_t frame_count, Rng& rng) { return {rng.Permutation(frame_count), {}}; }

EpochOrder WindowedOrder(const TrainingSet& set, double window_seconds, int run_frames, Rng& rng) {
  CANONPOSE_CHECK(window_seconds > 0.0 && run_frames > 0);
  std::vector<Run> runs;
  std::int64_t window = 0;
  for (const std::vector<std::size_t>& frames : CutIntoWindows(set, window_seconds, rng)) {
    const std::vector<std::size_t> permutation = rng.Permutation(frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (i % static_cast<std::size_t>(run_frames) == 0) runs.push_back({{}, window});
      runs.back().frames.push_back(frames[permutation[i]]);
    }
    ++window;
  }
  EpochOrder order;
  for (const std::size_t r : rng.Permutation(runs.size())) {
    order.frames.insert(order.frames.end(), runs[r].frames.begin(), runs[r].frames.end());
    order.windows.insert(order.windows.end(), runs[r].frames.size(), runs[r].window);
  }
  return order;
}

double WindowFactor(const TrainOptions& options, const Schedule& schedule, std::int64_t step) {
  if (options.camera_consistency != CameraConsistency::kWindow) return 0.0;
  const double end = options.camera_window_end * static_cast<double>(schedule.steps());
  return std::max(0.0, 1.0 - static_cast<double>(step) / end);
}

Batch Batches::At(std::int64_t step, std::uint64_t seed) {
  const std::int64_t epoch = step / schedule_.steps_per_epoch;
  if (epoch_ != epoch || seed_ != seed) {
    epoch_ = epoch;
    seed_ = seed;
    Rng rng(seed, {stream::kFrameOrder, static_cast<std::uint64_t>(epoch)});
    const double window = WindowFactor(options_, schedule_, epoch * schedule_.steps_per_epoch);
    order_ = window > 0.0 ? WindowedOrder(set_, window * options_.camera_window_seconds, kRunFrames, rng)
                          : ShuffledOrder(set_.frames.size(), rng);
  }
  const auto count = static_cast<std::size_t>(options_.batch_frames);
  const std::size_t first = static_cast<std::size_t>(step % schedule_.steps_per_epoch) * count;
  Batch batch;
  for (std::size_t i = first; i < std::min(first + count, order_.frames.size()); ++i) {
    batch.frames.push_back(&set_.frames[order_.frames[i]]);
    if (!order_.windows.empty()) batch.windows.push_back(order_.windows[i]);
  }
  return batch;
}

}  // namespace canonpose
