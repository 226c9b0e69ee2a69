// The order in which an epoch goes through the frames of a training set, and the windows of time that its batches hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

struct EpochOrder {
  std::vector<std::size_t> frames;    ///< every index into TrainingSet::frames once
  std::vector<std::int64_t> windows;  ///< for each of `frames`, the number of its window; empty without windows
};

/// All frames in a random order, without windows.
EpochOrder ShuffledOrder(std::size_t frame_count, Rng& rng);

/// Runs of up to `run_frames` frames, in a random order; the frames of a run are a random choice among those of one
/// window, frames of one sequence less than `window_seconds` apart. Windows lie end to end, from a random start.
EpochOrder WindowedOrder(const TrainingSet& set, double window_seconds, int run_frames, Rng& rng);

}  // namespace canonpose
