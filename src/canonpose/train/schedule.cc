#include "canonpose/train/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace canonpose {

Schedule MakeSchedule(const TrainOptions& options, std::size_t frames) {
  Schedule schedule;
  const auto batch = static_cast<std::int64_t>(options.batch_frames);
  schedule.steps_per_epoch = (static_cast<std::int64_t>(frames) + batch - 1) / batch;
  schedule.epochs = options.epochs;
  if (schedule.epochs == 0) {
    const std::int64_t needed = (options.min_steps + schedule.steps_per_epoch - 1) / schedule.steps_per_epoch;
    schedule.epochs = static_cast<int>(std::max<std::int64_t>(options.default_epochs, needed));
  }
  return schedule;
}

double LearningRateFactor(int epoch, int epochs) {
  double factor = 1.0;
  for (const double milestone : {0.3, 0.6, 0.9}) {
    if (epoch >= milestone * epochs) factor *= 0.1;
  }
  return factor;
}

double CosineFactor(std::int64_t step, std::int64_t steps) {
  const double done = static_cast<double>(step) / static_cast<double>(steps);
  return 0.5 * (1.0 + std::cos(std::numbers::pi * done));
}

double LearningRateFactor(const TrainOptions& options, const Schedule& schedule, std::int64_t step) {
  if (options.schedule == RateSchedule::kCosine) return CosineFactor(step, schedule.steps());
  return LearningRateFactor(static_cast<int>(step / schedule.steps_per_epoch), schedule.epochs);
}

}  // namespace canonpose
