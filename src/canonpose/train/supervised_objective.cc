// The objective that learns from 3D poses: truth, a solution's, or those of a calibrated triangulation.
#include <fmt/format.h>

#include "canonpose/train/augmentation.h"
#include "canonpose/train/batch_order.h"
#include "canonpose/train/objective.h"
#include "canonpose/train/streams.h"

namespace canonpose {
namespace {

/// What the poses to learn came from, in a sentence.
const char* SourceOfTargets(Supervision supervision) {
  if (supervision == Supervision::kTruth) return "truth";
  return supervision == Supervision::kSolved ? "solution" : "calibration";
}

class SupervisedObjective : public Objective {
 public:
  SupervisedObjective(const std::vector<Dataset>& datasets, const TrainingSet& set, const TrainOptions& options,
                      const Schedule& schedule, LifterState& lifter)
      : set_(set),
        supervision_(options.supervision),
        batches_(set, options, schedule),
        augmentation_(datasets, set, options),
        lifter_(lifter) {}

  Losses OfStep(std::int64_t step, std::uint64_t seed) override {
    Rng rng(seed, {stream::kAugmentation, static_cast<std::uint64_t>(step)});
    const RowChange change = [&](int row, const TrainingRow& copy) { augmentation_.Change(row, rng, copy); };
    return LossOf(
        GatherBatch(set_, batches_.At(step, seed).frames, lifter_.device, augmentation_.any() ? change : RowChange()));
  }

  Losses OfFrames(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames) override {
    return LossOf(GatherBatch(set, frames, lifter_.device));
  }

  [[nodiscard]] std::vector<LossTerm> Terms(const EpochSums& /*mean*/) const override { return {}; }
  [[nodiscard]] std::string WhyLeftOut() const override { return "no 3D pose to learn from"; }

  void Describe(ModelInfo& info) const override {
    info.mirror = {fmt::format("known from the {}", SourceOfTargets(supervision_)), 0.0, 0.0};
  }

 private:
  Losses LossOf(const BatchTensors& batch) {
    return ComputeSupervisedLoss(lifter_.network->forward(LifterInput(batch)), batch, lifter_.root);
  }

  const TrainingSet& set_;
  Supervision supervision_;
  Batches batches_;
  Augmentation augmentation_;
  LifterState& lifter_;
};

}  // namespace

std::unique_ptr<Objective> MakeSupervisedObjective(const std::vector<Dataset>& datasets, const TrainingSet& set,
                                                   const TrainOptions& options, const Schedule& schedule,
                                                   LifterState& lifter) {
  return std::make_unique<SupervisedObjective>(datasets, set, options, schedule, lifter);
}

}  // namespace canonpose
