#include "canonpose/train/training_loop.h"

#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"

namespace canonpose {
namespace {

using Clock = std::chrono::steady_clock;

/// True once in every period.
class Timer {
 public:
  explicit Timer(std::chrono::duration<double> period) : period_(period) {}
  [[nodiscard]] bool IsDue() const { return Clock::now() - start_ >= period_; }
  void Restart() { start_ = Clock::now(); }

 private:
  std::chrono::duration<double> period_;
  Clock::time_point start_ = Clock::now();
};

bool AreFinite(const Adam& adam) {
  for (const Adam::Parameter& parameter : adam.parameters()) {
    if (!torch::isfinite(parameter.value.detach()).all().item<bool>()) return false;
  }
  return true;
}

}  // namespace

bool TrainingLoop::Run() {
  LoopState& state = task_.state();
  Progress progress(label_, task_.StepsInAll(), task_.StepsDone());
  Timer report(Progress::kPeriod);
  Timer checkpoint{std::chrono::duration<double>(checkpoint_seconds_)};
  last_good_step_ = state.step;
  while (state.step < task_.steps()) {
    if (task_.IsDecisionDue()) {
      RequireFiniteLosses();
      task_.Decide();
    }
    const Losses losses = task_.Forward();  // forward
    losses.total.backward();                // backward
    task_.OnGradients();                    // gradients are known, parameters as they were
    task_.Update();                         // update
    state.sums.Add(losses);
    ++state.step;

    const bool ends_epoch = state.step % task_.steps_per_epoch() == 0;
    if (ends_epoch || report.IsDue() || progress.IsDue()) {
      const EpochSums sums = RequireFiniteLosses();
      report.Restart();
      if (progress.IsDue()) progress.Update(task_.StepsDone(), task_.DescribeLoss(sums));
      if (ends_epoch) {
        task_.EndEpoch(sums);
        state.sums.Set({});
      }
    }
    if (task_.IsStageOver()) {
      RequireSoundness();
      task_.EndStage();
      last_good_step_ = state.step;
    }
    const bool ends = state.step == task_.steps();
    const bool must_stop = !ends && StopRequested();
    if (checkpoint.IsDue() || must_stop || ends) {
      Save();
      checkpoint.Restart();
    }
    if (must_stop) return false;
  }
  return true;
}

void TrainingLoop::StartOrResume() {
  const std::optional<Checkpoint> checkpoint = folder_.ReadCheckpointToResume();
  if (!checkpoint) return Save();
  task_.Restore(*checkpoint, folder_.checkpoint_file());
  folder_.DropLaterMetrics(*checkpoint);
  LogInfo("continuing after step {}", checkpoint->info.steps);
}

void TrainingLoop::Save() {
  if (!folder_.exists()) return;
  RequireFiniteLosses();
  RequireSoundness();
  folder_.WriteCheckpoint(task_.MakeCheckpoint());
}

EpochSums TrainingLoop::RequireFiniteLosses() {
  const std::int64_t step = task_.state().step;
  const EpochSums sums = task_.state().sums.Read();
  if (!std::isfinite(sums.total)) {
    const std::string where = step == last_good_step_ + 1
                                  ? fmt::format("at step {}", step)
                                  : fmt::format("between steps {} and {}", last_good_step_ + 1, step);
    Fail(fmt::format("the loss became {} {} of {}", sums.total, where, task_.steps()));
  }
  last_good_step_ = step;
  return sums;
}

void TrainingLoop::RequireSoundness() {
  const double loss = task_.ProbeLoss();
  if (std::isfinite(loss) && AreFinite(task_.optimiser())) return;
  Fail(fmt::format("the network's weights or its loss ({}) are not finite after step {} of {}", loss,
                   task_.state().step, task_.steps()));
}

void TrainingLoop::Fail(const std::string& what) {
  ThrowComputation("{}; {}; try again with a smaller `learning_rate`", what, folder_.KeepLastGoodModel());
}

}  // namespace canonpose
