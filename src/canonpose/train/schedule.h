// How long to train, and with what learning rate.
#pragma once

#include <cstddef>
#include <cstdint>

#include "canonpose/train/options.h"

namespace canonpose {

struct Schedule {
  int epochs = 0;
  std::int64_t steps_per_epoch = 0;
  [[nodiscard]] std::int64_t steps() const { return epochs * steps_per_epoch; }
};

/// The number of epochs and steps, by `options`, for `frames` training frames.
Schedule MakeSchedule(const TrainOptions& options, std::size_t frames);

/// The factor of the learning rate in an epoch, counted from 0: x 0.1 after 30, 60 and 90 % of the epochs.
double LearningRateFactor(int epoch, int epochs);

/// Half a cosine from 1 down to 0, at a step counted from 0.
double CosineFactor(std::int64_t step, std::int64_t steps);

/// The factor in a step, counted from 0, by `options.schedule`.
double LearningRateFactor(const TrainOptions& options, const Schedule& schedule, std::int64_t step);

}  // namespace canonpose
