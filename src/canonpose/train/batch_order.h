// The order of the frames in an epoch, and the windows of time that batches take them from.
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
  std::vector<std::int64_t> windows;  ///< the number of the window of each of `frames`; empty without windows
};

/// All frames in a random order, without windows.
EpochOrder ShuffledOrder(std::size_t frame_count, Rng& rng);

/// Cuts sequences into windows of `window_seconds`, end to end from a random start, and every window into runs of up to
/// `run_frames` random frames. The order is that of the runs, shuffled.
EpochOrder WindowedOrder(const TrainingSet& set, double window_seconds, int run_frames, Rng& rng);

/// The factor of the length and the weight of the window of camera consistency at a step: it falls linearly from 1 to
/// 0, which it reaches at `camera_window_end`. 0 without windows.
double WindowFactor(const TrainOptions& options, const Schedule& schedule, std::int64_t step);

struct Batch {
  std::vector<const TrainingFrame*> frames;
  std::vector<std::int64_t> windows;  ///< of each frame, as in EpochOrder
};

/// The batches of a run. Each depends on the seed and its number alone. Keeps references.
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
