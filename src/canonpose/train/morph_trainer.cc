#include "canonpose/train/morph_trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/random.h"
#include "canonpose/base/version.h"
#include "canonpose/model/morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/optimiser_state.h"
#include "canonpose/train/run_folder.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/streams.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Fewer poses than this teach nothing of other people.
constexpr std::size_t kMinPairs = 100;

class MorphRun {
 public:
  explicit MorphRun(const MorphJob& job);
  void Restore(const Checkpoint& checkpoint);
  void Save() const;
  /// Returns the signal that ended it, or 0.
  /// False where it was asked to stop before the end; the checkpoint is saved.
  bool Run();
  MorphReport Finish();

 private:
  [[nodiscard]] std::int64_t steps_per_epoch() const {
    const auto batch = static_cast<std::int64_t>(job_.options.batch_poses);
    return (training_count_ + batch - 1) / batch;
  }
  [[nodiscard]] std::int64_t steps() const { return job_.options.epochs * steps_per_epoch(); }
  /// Rows of the batch of a step, a function of its number alone.
  [[nodiscard]] torch::Tensor BatchRows();
  torch::Tensor Loss(const torch::Tensor& rows);
  void TakeStep();
  void EndEpoch();
  [[nodiscard]] fs::path File(const char* name) const { return job_.run_folder / name; }

  const MorphJob& job_;
  torch::Device device_;
  torch::Tensor input_;   // (N, 3J)
  torch::Tensor offset_;  // (N, 2J)
  std::int64_t training_count_;
  Morph network_;
  Adam adam_;
  ModelInfo info_;
  EpochSums sums_;
  std::int64_t step_ = 0;
  std::vector<std::size_t> order_;  // of the epoch `order_epoch_`
  std::int64_t order_epoch_ = -1;
};

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

MorphRun::MorphRun(const MorphJob& job)
    : job_(job),
      device_(job.options.device == "cuda" ? torch::kCUDA : torch::kCPU),
      input_(Rows(job.pairs.input, job.pairs.count(), device_)),
      offset_(Rows(job.pairs.offset, job.pairs.count(), device_)),
      training_count_(static_cast<std::int64_t>((1.0 - job.options.validation) * static_cast<double>(input_.size(0)))),
      network_(NewMorph(job, device_)),
      adam_(NamedParameters(*network_), /*weight_decay=*/0.0) {
  info_.program_version = ProgramVersion();
  info_.skeleton = job.skeleton;
  info_.source = job.source;
  info_.network = NetworkKind::kMorph;
  info_.width = job.options.width;
  info_.preset = "morph";
  info_.options = job.options.ToJson();
  info_.seed = job.options.seed;
  info_.data_files = job.data_files;
  info_.data_fingerprints = job.data_fingerprints;
}

torch::Tensor MorphRun::BatchRows() {
  const std::int64_t epoch = step_ / steps_per_epoch();
  if (epoch != order_epoch_) {
    Rng rng(job_.options.seed, {stream::kFrameOrder, static_cast<std::uint64_t>(epoch)});
    order_ = rng.Permutation(static_cast<std::size_t>(training_count_));
    order_epoch_ = epoch;
  }
  const std::int64_t first = step_ % steps_per_epoch() * job_.options.batch_poses;
  const std::int64_t last = std::min<std::int64_t>(first + job_.options.batch_poses, training_count_);
  const std::vector<std::int64_t> rows(order_.begin() + first, order_.begin() + last);
  return torch::tensor(rows, torch::kInt64).to(device_);
}

torch::Tensor MorphRun::Loss(const torch::Tensor& rows) {
  const torch::Tensor target = offset_.index_select(0, rows);
  const torch::Tensor known = torch::isfinite(target).to(torch::kFloat32);
  const torch::Tensor moved = network_->forward(input_.index_select(0, rows));
  const torch::Tensor difference = (moved - torch::nan_to_num(target)).abs() * known;
  return difference.sum() / torch::clamp_min(known.sum(), 1.0);
}

void MorphRun::TakeStep() {
  const torch::Tensor loss = Loss(BatchRows());
  const double value = loss.item<double>();
  if (!std::isfinite(value)) {
    ThrowComputation("the loss became {} at step {} of {}; try again with a smaller `learning_rate`", value, step_ + 1,
                     steps());
  }
  loss.backward();
  adam_.Step(job_.options.learning_rate * CosineFactor(step_, steps()));
  sums_.total += value;
  ++sums_.steps;
  ++step_;
}

void MorphRun::EndEpoch() {
  Json line;
  line["epoch"] = step_ / steps_per_epoch();
  line["step"] = step_;
  line["loss"] = sums_.total / static_cast<double>(sums_.steps);
  AppendLine(File("metrics.jsonl"), line.dump());
  sums_ = {};
}

void MorphRun::Save() const {
  Checkpoint checkpoint;
  checkpoint.info = info_;
  checkpoint.info.steps = step_;
  checkpoint.sums = sums_;
  StoreOptimiser(adam_, checkpoint);
  WriteCheckpoint(File("checkpoint.h5"), checkpoint);
}

void MorphRun::Restore(const Checkpoint& checkpoint) {
  const std::string file = File("checkpoint.h5").string();
  if (checkpoint.info.options != info_.options || checkpoint.info.data_fingerprints != info_.data_fingerprints) {
    ThrowBadInput({file, "", "a run of the same data and options", "one of others",
                   "resume with those the run was started with, or train into another folder"});
  }
  LoadParameters(*network_, checkpoint.parameters, file);
  RestoreOptimiser(checkpoint, file, adam_);
  step_ = checkpoint.info.steps;
  adam_.set_step_count(step_);
  sums_ = checkpoint.sums;
}

bool MorphRun::Run() {
  Progress progress("train-morph", static_cast<long>(steps()), static_cast<long>(step_));
  auto last_save = Clock::now();
  while (step_ < steps()) {
    TakeStep();
    if (progress.IsDue() && sums_.steps > 0) {
      progress.Update(static_cast<long>(step_),
                      fmt::format("loss {:.4f}", sums_.total / static_cast<double>(sums_.steps)));
    }
    if (step_ % steps_per_epoch() == 0) EndEpoch();
    const double since_save = std::chrono::duration<double>(Clock::now() - last_save).count();
    const bool must_stop = step_ < steps() && StopRequested();
    if (since_save >= job_.options.checkpoint_seconds || must_stop || step_ == steps()) {
      Save();
      last_save = Clock::now();
    }
    if (must_stop) return false;
  }
  return true;
}

/// Mean length of planar differences (N, 2J) over the joints that are known, % of the pose's size.
double MeanLengthPercent(const torch::Tensor& difference) {
  const std::int64_t joints = difference.size(1) / 2;
  const torch::Tensor length = difference.view({-1, 2, joints}).square().sum(1).sqrt();  // (N, J)
  const torch::Tensor known = torch::isfinite(length);
  return 100.0 * std::sqrt(static_cast<double>(joints)) * length.masked_select(known).mean().item<double>();
}

MorphReport MorphRun::Finish() {
  const torch::NoGradGuard no_grad;
  info_.steps = step_;
  WriteModelFile(File("model.cpm"), {info_, ParametersOf(*network_)});
  MorphReport report;
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
  PrepareRunFolder(job.run_folder, job.resume, job.overwrite);
  MorphRun run(job);
  const fs::path checkpoint_path = job.run_folder / "checkpoint.h5";
  if (job.resume && fs::exists(checkpoint_path)) {
    const Checkpoint checkpoint = ReadCheckpoint(checkpoint_path);
    run.Restore(checkpoint);
    DropLaterMetrics(job.run_folder / "metrics.jsonl", checkpoint.info.steps, 0);
    LogInfo("going on after step {}", checkpoint.info.steps);
  } else {
    fs::remove(job.run_folder / "metrics.jsonl");
    run.Save();
  }
  MorphReport report;
  report.stopped = !run.Run();
  if (!report.stopped) report = run.Finish();
  return report;
}

}  // namespace canonpose
