// The objective of the published method: poses and rotations that are exchanged between views (losses.h), then the
// decisions about the mirror and the trap.
#include "canonpose/train/augmentation.h"
#include "canonpose/train/batch_order.h"
#include "canonpose/train/mirror.h"
#include "canonpose/train/objective.h"
#include "canonpose/train/optimiser_state.h"
#include "canonpose/train/streams.h"
#include "canonpose/train/trap.h"

namespace canonpose {
namespace {

class ViewObjective : public Objective {
 public:
  ViewObjective(const TrainingSet& set, const TrainOptions& options, const Schedule& schedule, LifterState& lifter)
      : set_(set),
        options_(options),
        schedule_(schedule),
        batches_(set, options, schedule),
        lifter_(lifter),
        perspective_(torch::zeros({}, torch::TensorOptions(lifter.device)).requires_grad_()),
        perspective_adam_({{kPerspectiveParameter, perspective_}}, /*weight_decay=*/0.0) {}

  Losses OfStep(std::int64_t step, std::uint64_t seed) override {
    const auto [frames, windows] = batches_.At(step, seed);
    BatchTensors batch = GatherBatch(set_, frames, lifter_.device);
    Rng permutations(seed, {stream::kPermutations, static_cast<std::uint64_t>(step)});
    const bool is_static = options_.camera_consistency == CameraConsistency::kStatic;
    const double window = is_static ? 1.0 : WindowFactor(options_, schedule_, step);
    const BatchPairs pairs = MakeBatchPairs(
        frames, set_.static_captures, is_static || (window > 0.0 && !windows.empty()),
        [&](std::size_t count) { return permutations.Permutation(count); }, windows);
    return LossesOf(batch, pairs, {1.0, options_.view_weight, options_.camera_weight * window});
  }

  Losses OfFrames(const TrainingSet& set, const std::vector<const TrainingFrame*>& frames) override {
    BatchTensors batch = GatherBatch(set, frames, lifter_.device);
    return LossesOf(batch, MakeBatchPairs(frames, set.static_captures, false, nullptr),
                    {1.0, options_.view_weight, 0.0});
  }

  [[nodiscard]] std::vector<LossTerm> Terms(const EpochSums& mean) const override {
    return {{"reprojection", mean.reprojection}, {"view", mean.view}, {"camera", mean.camera}};
  }
  [[nodiscard]] std::string WhyLeftOut() const override { return "seen by fewer than two cameras"; }

  /// The warm-up ends: the mirror is decided, so that the perspective factor can be learned with its right sign.
  [[nodiscard]] bool IsDecisionDue(std::int64_t step) const override {
    return learns_perspective() && step == warmup_steps();
  }

  void Decide() override {
    DecideMirror();
    FreePerspectiveIfDecided();
  }

  void Update() override {
    if (!perspective_is_free_) return;
    perspective_adam_.Step(options_.perspective_learning_rate);
    // A negative factor belongs to the mirrored solution.
    const torch::NoGradGuard no_grad;
    perspective_.clamp_(0.0);
  }

  void Finish() override {
    DecideMirror();
    trap_ = ReportTrap(MeasureTrapSigns(*lifter_.network, set_, lifter_.root, lifter_.device), InputFormOf(options_));
  }

  void Describe(ModelInfo& info) const override {
    info.mirror = mirror_;
    info.perspective = perspective_.item<double>();
    info.trap = trap_;
  }

  void Reset() override {
    perspective_.detach().zero_();
    ResetOptimiser(perspective_adam_);
    perspective_is_free_ = false;
    mirror_ = {};
  }

  void Store(Checkpoint& checkpoint) const override {
    checkpoint.perspective_steps = perspective_adam_.step_count();
    StoreOptimiser(perspective_adam_, checkpoint);
  }

  void Restore(const Checkpoint& checkpoint, const std::string& file) override {
    RestoreOptimiser(checkpoint, file, perspective_adam_);
    perspective_adam_.set_step_count(checkpoint.perspective_steps);
    mirror_ = checkpoint.info.mirror;
    perspective_is_free_ = false;
    if (checkpoint.info.steps > warmup_steps()) FreePerspectiveIfDecided();
  }

 private:
  [[nodiscard]] bool learns_perspective() const { return options_.perspective == PerspectiveForm::kLearned; }
  [[nodiscard]] std::int64_t warmup_steps() const {
    return static_cast<std::int64_t>(options_.perspective_warmup * static_cast<double>(schedule_.steps()));
  }

  /// May change the batch's confidences.
  Losses LossesOf(BatchTensors& batch, const BatchPairs& pairs, const LossWeights& weights) {
    const LifterOutput output = lifter_.network->forward(LifterInput(batch));
    if (!options_.loss_confidences) WeighSeenJointsAlike(batch);
    // Undefined while projection is weak perspective.
    const torch::Tensor perspective = perspective_is_free_ ? perspective_ : torch::Tensor();
    return ComputeLosses(output, batch, pairs, weights, perspective, lifter_.root, options_.consistency);
  }

  void DecideMirror() {
    const PerspectiveSlope slope = MeasurePerspectiveSlope(*lifter_.network, set_, lifter_.root, lifter_.device);
    if (!UpdateMirrorDecision(slope, options_.mirror, mirror_)) return;
    lifter_.network->Mirror();
    for (Adam::Parameter& parameter : lifter_.adam.parameters()) {
      lifter_.network->MirrorRows(parameter.name, parameter.first_moment);
    }
  }

  void FreePerspectiveIfDecided() { perspective_is_free_ = learns_perspective() && mirror_.decision != "undecided"; }

  const TrainingSet& set_;
  const TrainOptions& options_;
  const Schedule& schedule_;
  Batches batches_;
  LifterState& lifter_;
  torch::Tensor perspective_;
  Adam perspective_adam_;
  bool perspective_is_free_ = false;
  MirrorDecision mirror_;
  TrapFinding trap_;
};

}  // namespace

std::unique_ptr<Objective> MakeViewObjective(const TrainingSet& set, const TrainOptions& options,
                                             const Schedule& schedule, LifterState& lifter) {
  return std::make_unique<ViewObjective>(set, options, schedule, lifter);
}

}  // namespace canonpose
