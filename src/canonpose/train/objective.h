// What a lifter is trained to do: the losses of its batches, and what is decided and recorded because of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "canonpose/data/dataset.h"
#include "canonpose/model/lifter.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/options.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// A lifter and its optimiser.
struct LifterState {
  std::shared_ptr<LiftingNetwork> network;
  Adam adam;
  torch::Device device;
  int root = 0;  ///< the skeleton's root joint
};

/// One of the terms that a total loss is made of, mean over some steps.
struct LossTerm {
  std::string name;
  double value = 0.0;
};

class Objective {
 public:
  virtual ~Objective() = default;

  /// The losses of the batch of a step. They depend on the step's number, the seed and the lifter alone.
  virtual Losses OfStep(std::int64_t step, std::uint64_t seed) = 0;
  /// The losses of some frames of a set as they are: without augmentation, and without camera consistency.
  virtual Losses OfFrames(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames) = 0;
  /// The terms of `mean`, to show beside the total.
  [[nodiscard]] virtual std::vector<LossTerm> Terms(const EpochSums& mean) const = 0;
  /// Why frames cannot be used, as in "5 left out (seen by fewer than two cameras)".
  [[nodiscard]] virtual std::string WhyLeftOut() const = 0;

  /// Whether something is to be decided before a step, and the decision. May change the lifter.
  [[nodiscard]] virtual bool IsDecisionDue(std::int64_t /*step*/) const { return false; }
  virtual void Decide() {}
  /// Updates the objective's own parameters from their gradients, and clears those.
  virtual void Update() {}
  /// After the last step: makes the last decisions, which may change the lifter, and judges the result.
  virtual void Finish() {}
  /// Enters what is known: the mirror, the perspective factor, the trap.
  virtual void Describe(ModelInfo& info) const = 0;

  /// Forgets all that was learned.
  virtual void Reset() {}
  virtual void Store(Checkpoint& /*checkpoint*/) const {}
  /// Throws Error(kBadInput) naming `file` where something is missing.
  virtual void Restore(const Checkpoint& /*checkpoint*/, const std::string& /*file*/) {}
};

/// Learning from poses and rotations that are exchanged between views (train/losses.h), the method. Keeps references.
std::unique_ptr<Objective> MakeViewObjective(const TrainingSet& set, const TrainOptions& options,
                                             const Schedule& schedule, LifterState& lifter);

/// Learning from 3D poses. Keeps references, except to `datasets`.
std::unique_ptr<Objective> MakeSupervisedObjective(const std::vector<Dataset>& datasets, const TrainingSet& set,
                                                   const TrainOptions& options, const Schedule& schedule,
                                                   LifterState& lifter);

}  // namespace canonpose
