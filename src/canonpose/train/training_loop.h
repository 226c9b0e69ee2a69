// The loop that trains lifters and morphing networks: forward, backward, update, and what happens between two steps.
#pragma once

#include <cstdint>
#include <string>

#include <torch/torch.h>

#include "canonpose/train/adam.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/loss_sums.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/run_folder.h"

namespace canonpose {

/// Where a training is.
struct LoopState {
  std::int64_t step = 0;  ///< steps done
  LossSums sums;          ///< of the running epoch's steps
};

/// What the loop trains. Its state between two steps is all that the later ones depend on: saved and restored there, it
/// continues to the same bits.
class TrainingTask {
 public:
  virtual ~TrainingTask() = default;

  [[nodiscard]] virtual LoopState& state() = 0;
  [[nodiscard]] virtual std::int64_t steps() const = 0;  ///< in all
  [[nodiscard]] virtual std::int64_t steps_per_epoch() const = 0;
  [[nodiscard]] virtual const Adam& optimiser() const = 0;

  /// Before a step: whether something is to be decided by what was learned so far, and the decision.
  [[nodiscard]] virtual bool IsDecisionDue() { return false; }
  virtual void Decide() {}
  /// Forward: the losses of the batch of step `state().step`, for the backward pass.
  virtual Losses Forward() = 0;
  /// Between gradient and update: all gradients are complete, and no parameter has changed.
  virtual void OnGradients() {}
  /// Update: one step of the optimiser, which clears the gradients.
  virtual void Update() = 0;
  /// After the last step of an epoch: `sums` of its losses.
  virtual void EndEpoch(const EpochSums& sums) = 0;
  /// After a step: whether it ended a stage of the training, such as one of several restarts, and what follows from
  /// that. May set `state()` back.
  [[nodiscard]] virtual bool IsStageOver() { return false; }
  virtual void EndStage() {}

  /// The total loss of the next batch, without gradients.
  virtual double ProbeLoss() = 0;

  [[nodiscard]] virtual Checkpoint MakeCheckpoint() = 0;
  /// Throws Error(kBadInput) naming `file` where the checkpoint is of other data or options.
  virtual void Restore(const Checkpoint& checkpoint, const std::string& file) = 0;

  /// For the caller's progress: steps done and in all, and "loss 0.21" from the running epoch's sums.
  [[nodiscard]] virtual std::int64_t StepsDone() { return state().step; }
  [[nodiscard]] virtual std::int64_t StepsInAll() { return steps(); }
  [[nodiscard]] virtual std::string DescribeLoss(const EpochSums& sums) const = 0;
};

class TrainingLoop {
 public:
  /// `label` is what progress is called. Keeps references.
  TrainingLoop(TrainingTask& task, RunFolder& folder, std::string label, double checkpoint_seconds)
      : task_(task), folder_(folder), label_(std::move(label)), checkpoint_seconds_(checkpoint_seconds) {}

  /// Continues from the folder's checkpoint where it is to be resumed; otherwise saves the untrained state.
  void StartOrResume();

  /// Runs to the last step. False where the caller asked it to stop before; the checkpoint is saved then.
  ///
  /// No step waits for the device: losses are read a few times per second, at the end of an epoch and before saving.
  /// One that is not finite is found then; Error(kComputation) says between which steps it was, and where the last good
  /// model is.
  bool Run();

  /// Throws Error(kComputation) where the task's parameters or its next loss are not finite: an update may have spoiled
  /// them after the last loss. Only a sound state is worth keeping.
  void RequireSoundness();

 private:
  void Save();
  /// Of the losses since it was called last.
  EpochSums RequireFiniteLosses();
  [[noreturn]] void Fail(const std::string& what);

  TrainingTask& task_;
  RunFolder& folder_;
  std::string label_;
  double checkpoint_seconds_;
  std::int64_t last_good_step_ = 0;
};

}  // namespace canonpose
