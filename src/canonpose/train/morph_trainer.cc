#include "canonpose/train/morph_trainer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"
#include "canonpose/base/version.h"
#include "canonpose/model/morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/optimiser_state.h"
#include "canonpose/train/run_folder.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/streams.h"
#include "canonpose/train/training_loop.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

/// Fewer poses say nothing about other people.
constexpr std::size_t kMinPairs = 100;

Morph NewMorph(const MorphJob& job, torch::Device device) {
  Morph network(job.pairs.joint_count, job.options.width);
  network->Initialise(Rng(job.options.seed, {stream::kInitialisation}).Bits());
  network->to(device);
  return network;
}

torch::Tensor Rows(const std::vector<float>& values, std::size_t count, torch::Device device) {
  const auto rows = static_cast<std::int64_t>(count);
  return torch::tensor(values).view({rows, -1}).to(device);
}

ModelInfo DescribeModel(const MorphJob& job) {
  ModelInfo info;
  info.program_version = ProgramVersion();
  info.skeleton = job.skeleton;
  info.source = job.source;
  info.network = NetworkKind::kMorph;
  info.width = job.options.width;
  info.preset = "morph";
  info.options = job.options.ToJson();
  info.seed = job.options.seed;
  info.data_files = job.data_files;
  info.data_fingerprints = job.data_fingerprints;
  return info;
}

/// Mean length of planar differences (N, 2J) over the joints that are known, % of the pose's size.
double MeanLengthPercent(const torch::Tensor& difference) {
  const std::int64_t joints = difference.size(1) / 2;
  const torch::Tensor length = difference.view({-1, 2, joints}).square().sum(1).sqrt();  // (N, J)
  const torch::Tensor known = torch::isfinite(length);
  return 100.0 * std::sqrt(static_cast<double>(joints)) * length.masked_select(known).mean().item<double>();
}

class MorphTraining : public TrainingTask {
 public:
  MorphTraining(const MorphJob& job, RunFolder& folder)
      : options_(job.options),
        folder_(folder),
        device_(options_.device == "cuda" ? torch::kCUDA : torch::kCPU),
        input_(Rows(job.pairs.input, job.pairs.count(), device_)),
        offset_(Rows(job.pairs.offset, job.pairs.count(), device_)),
        training_count_(static_cast<std::int64_t>((1.0 - options_.validation) * static_cast<double>(input_.size(0)))),
        network_(NewMorph(job, device_)),
        adam_(NamedParameters(*network_), /*weight_decay=*/0.0),
        info_(DescribeModel(job)),
        state_{0, LossSums(device_)} {}

  [[nodiscard]] LoopState& state() override { return state_; }
  [[nodiscard]] std::int64_t steps() const override { return options_.epochs * steps_per_epoch(); }
  [[nodiscard]] std::int64_t steps_per_epoch() const override {
    const auto batch = static_cast<std::int64_t>(options_.batch_poses);
    return (training_count_ + batch - 1) / batch;
  }
  [[nodiscard]] const Adam& optimiser() const override { return adam_; }

  Losses Forward() override { return LossOfStep(state_.step); }
  void Update() override { adam_.Step(options_.learning_rate * CosineFactor(state_.step, steps())); }
  double ProbeLoss() override {
    const torch::NoGradGuard no_grad;
    return LossOfStep(std::min(state_.step, steps() - 1)).total.item<double>();
  }

  void EndEpoch(const EpochSums& sums) override {
    Json line;
    line["epoch"] = state_.step / steps_per_epoch();
    line["step"] = state_.step;
    line["loss"] = sums.Mean().total;
    folder_.AddMetrics(line.dump());
  }

  [[nodiscard]] Checkpoint MakeCheckpoint() override;
  void Restore(const Checkpoint& checkpoint, const std::string& file) override;
  [[nodiscard]] std::string DescribeLoss(const EpochSums& sums) const override {
    return fmt::format("loss {:.4f}", sums.Mean().total);
  }

  /// After the last step.
  MorphReport Finish();

 private:
  /// Rows of the batch of a step, which depend on its number alone.
  [[nodiscard]] torch::Tensor BatchRows(std::int64_t step);
  Losses LossOfStep(std::int64_t step);

  MorphOptions options_;
  RunFolder& folder_;
  torch::Device device_;
  torch::Tensor input_;   // (N, 3J)
  torch::Tensor offset_;  // (N, 2J)
  std::int64_t training_count_;
  Morph network_;
  Adam adam_;
  ModelInfo info_;
  LoopState state_;
  std::vector<std::size_t> order_;  // of the epoch `order_epoch_`
  std::int64_t order_epoch_ = -1;
};

torch::Tensor MorphTraining::BatchRows(std::int64_t step) {
  const std::int64_t epoch = step / steps_per_epoch();
  if (epoch != order_epoch_) {
    Rng rng(options_.seed, {stream::kFrameOrder, static_cast<std::uint64_t>(epoch)});
    order_ = rng.Permutation(static_cast<std::size_t>(training_count_));
    order_epoch_ = epoch;
  }
  const std::int64_t first = step % steps_per_epoch() * options_.batch_poses;
  const std::int64_t last = std::min<std::int64_t>(first + options_.batch_poses, training_count_);
  const std::vector<std::int64_t> rows(order_.begin() + first, order_.begin() + last);
  return torch::tensor(rows, torch::kInt64).to(device_);
}

Losses MorphTraining::LossOfStep(std::int64_t step) {
  const torch::Tensor rows = BatchRows(step);
  const torch::Tensor target = offset_.index_select(0, rows);
  const torch::Tensor known = torch::isfinite(target).to(torch::kFloat32);
  const torch::Tensor moved = network_->forward(input_.index_select(0, rows));
  const torch::Tensor difference = (moved - torch::nan_to_num(target)).abs() * known;
  Losses losses;
  losses.total = difference.sum() / torch::clamp_min(known.sum(), 1.0);
  return losses;
}

Checkpoint MorphTraining::MakeCheckpoint() {
  Checkpoint checkpoint;
  checkpoint.info = info_;
  checkpoint.info.steps = state_.step;
  checkpoint.sums = state_.sums.Read();
  StoreOptimiser(adam_, checkpoint);
  return checkpoint;
}

void MorphTraining::Restore(const Checkpoint& checkpoint, const std::string& file) {
  if (checkpoint.info.options != info_.options || checkpoint.info.data_fingerprints != info_.data_fingerprints) {
    ThrowBadInput({file, "", "a run with the same data and options", "one with others",
                   "resume with those the run was started with, or train into another folder"});
  }
  LoadParameters(*network_, checkpoint.parameters, file);
  RestoreOptimiser(checkpoint, file, adam_);
  adam_.set_step_count(checkpoint.info.steps);
  state_.step = checkpoint.info.steps;
  state_.sums.Set(checkpoint.sums);
}

MorphReport MorphTraining::Finish() {
  const torch::NoGradGuard no_grad;
  info_.steps = state_.step;
  MorphReport report;
  report.model = {info_, ParametersOf(*network_)};
  folder_.WriteModel(report.model);
  report.before_percent = report.after_percent = std::nan("");
  const std::int64_t held_out = input_.size(0) - training_count_;
  if (held_out > 0) {
    const torch::Tensor offset = offset_.narrow(0, training_count_, held_out);
    report.before_percent = MeanLengthPercent(offset);
    report.after_percent = MeanLengthPercent(offset - network_->forward(input_.narrow(0, training_count_, held_out)));
  }
  return report;
}

}  // namespace

MorphReport TrainMorph(const MorphJob& job) {
  job.options.Validate();
  RequireDevice(job.options.device);
  const ThreadScope threads(job.options.threads);
  WarnAboutSlowLinearAlgebra();
  if (job.pairs.count() < kMinPairs) {
    ThrowComputation("{} pairs of a detected and a true 2D pose are too few to learn from: {} are needed",
                     job.pairs.count(), kMinPairs);
  }
  RunFolder folder(job.run_folder, job.resume, job.overwrite);
  MorphTraining training(job, folder);
  TrainingLoop loop(training, folder, "train-morph", job.options.checkpoint_seconds);
  folder.RemoveOldRecords();
  loop.StartOrResume();
  MorphReport report;
  report.stopped = !loop.Run();
  if (!report.stopped) {
    loop.RequireSoundness();
    report = training.Finish();
  }
  return report;
}

}  // namespace canonpose
