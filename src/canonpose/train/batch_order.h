// The order in which an epoch goes through the frames of a training set, and the windows of time that its batches hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/train/options.h"
#include "canonpose/train/schedule.h"
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

/// What is left at a step of the window of camera consistency, of its length and of its weight: it falls linearly from
/// 1 to 0, which it reaches at `camera_window_end`. 0 where camera consistency is not kept within windows.
double WindowLeft(const TrainOptions& options, const Schedule& schedule, std::int64_t step);

struct Batch {
  std::vector<const TrainingFrame*> frames;
  std::vector<std::int64_t> windows;  ///< of each frame, as in EpochOrder
};

/// The batches of a run, each a function of its seed and number alone. Refers to what it is made of.
class Batches {
 public:
  Batches(const TrainingSet& set, const TrainOptions& options, const Schedule& schedule)
      : set_(set), options_(options), schedule_(schedule) {}
  Batch At(std::int64_t step, std::uint64_t seed);

 private:
  const TrainingSet& set_;
  const TrainOptions& options_;
  const Schedule& schedule_;
  // The last epoch asked for.
  std::int64_t epoch_ = -1;
  std::uint64_t seed_ = 0;
  EpochOrder order_;
};

}  // namespace canonpose
