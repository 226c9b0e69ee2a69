#include "canonpose/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/interrupt.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/version.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/augmentation.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/data_checks.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/mirror.h"
#include "canonpose/train/run_folder.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What a generator is for, as its first stream number.
enum Stream : std::uint64_t { kInitialisation = 1, kFrameOrder = 2, kPermutations = 3, kAugmentation = 4 };

constexpr const char* kPerspectiveName = "perspective";

/// The state of a run and the steps of its life; Train() below is the plot.
class TrainingRun {
 public:
  TrainingRun(const TrainJob& job, TrainingSplit split);

  [[nodiscard]] const TrainingSplit& split() const { return split_; }
  [[nodiscard]] const Schedule& schedule() const { return schedule_; }
  void Restore(const Checkpoint& checkpoint);
  void Save();
  /// Trains until the end or a signal; returns the signal.
  int Run();
  TrainReport Finish();

 private:
  [[nodiscard]] bool is_supervised() const { return options_.supervision != "none"; }
  [[nodiscard]] bool wants_perspective() const { return options_.perspective == "learned"; }
  [[nodiscard]] std::int64_t warmup_steps() const {
    return static_cast<std::int64_t>(options_.perspective_warmup * static_cast<double>(schedule_.steps()));
  }
  [[nodiscard]] int epoch_of(std::int64_t step) const { return static_cast<int>(step / schedule_.steps_per_epoch); }
  [[nodiscard]] int epoch() const { return epoch_of(step_); }
  /// The factor as the losses take it; undefined while projection is weak perspective.
  [[nodiscard]] torch::Tensor PerspectiveInLosses() const {
    return perspective_is_free_ ? perspective_ : torch::Tensor();
  }

  std::vector<const TrainingFrame*> BatchOf(std::int64_t step);
  void TakeStep();
  Losses BatchLosses(std::int64_t step);
  void RequireSoundness();
  [[noreturn]] void StopAtBadLoss(const std::string& what);
  void EndEpoch();
  [[nodiscard]] std::string DescribeLoss() const;
  std::optional<double> ValidationLoss();
  void DecideMirror();
  void Mirror();
  void FreePerspectiveIfDecided();
  [[nodiscard]] Checkpoint MakeCheckpoint() const;
  [[nodiscard]] fs::path File(const char* name) const { return run_folder_ / name; }

  TrainOptions options_;
  fs::path run_folder_;
  TrainingSplit split_;
  Schedule schedule_;
  Augmentation augmentation_;
  int root_;
  torch::Device device_;
  Lifter lifter_;
  torch::Tensor perspective_;
  Adam adam_;
  Adam perspective_adam_;
  bool perspective_is_free_ = false;
  ModelInfo info_;
  EpochSums sums_;
  std::int64_t step_ = 0;
  int order_epoch_ = -1;
  std::vector<std::size_t> order_;
  std::chrono::steady_clock::time_point epoch_start_ = std::chrono::steady_clock::now();
};

std::vector<std::pair<std::string, torch::Tensor>> NamedParameters(const Lifter& lifter) {
  std::vector<std::pair<std::string, torch::Tensor>> parameters;
  for (const auto& item : lifter->named_parameters()) parameters.emplace_back(item.key(), item.value());
  return parameters;
}

Lifter NewLifter(int joints, const TrainOptions& options, torch::Device device) {
  Lifter lifter(joints, options.width, RotationFormNamed(options.rotation));
  lifter->Initialise(Rng(options.seed, {kInitialisation}).Bits());
  lifter->to(device);
  return lifter;
}

TrainingRun::TrainingRun(const TrainJob& job, TrainingSplit split)
    : options_(job.options),
      run_folder_(job.run_folder),
      split_(std::move(split)),
      schedule_(MakeSchedule(options_, split_.training.frames.size())),
      augmentation_(job.datasets, split_.training, options_),
      root_(job.datasets.front().skeleton.root),
      device_(options_.device == "cuda" ? torch::kCUDA : torch::kCPU),
      lifter_(NewLifter(split_.training.joint_count, options_, device_)),
      perspective_(torch::zeros({}, torch::TensorOptions(device_)).requires_grad_()),
      adam_(NamedParameters(lifter_), options_.weight_decay),
      perspective_adam_({{kPerspectiveName, perspective_}}, 0.0) {
  info_.program_version = ProgramVersion();
  info_.skeleton = job.datasets.front().skeleton;
  info_.source = job.datasets.front().source;
  info_.width = options_.width;
  info_.rotation = options_.rotation;
  info_.input = {options_.ray, options_.focal};
  info_.preset = options_.preset;
  info_.options = options_.ToJson(/*only_what_changes_results=*/true);
  info_.seed = options_.seed;
  info_.data_files = job.data_files;
  for (const Dataset& dataset : job.datasets) info_.data_fingerprints.push_back(FingerprintOf(dataset, options_));
}

Checkpoint TrainingRun::MakeCheckpoint() const {
  Checkpoint checkpoint{info_, sums_, perspective_adam_.step_count(), {}, {}, {}};
  checkpoint.info.steps = step_;
  checkpoint.info.perspective = perspective_.item<double>();
  for (const Adam* adam : {&adam_, &perspective_adam_}) {
    for (const Adam::Parameter& parameter : adam->parameters()) {
      checkpoint.parameters[parameter.name] = ToArray(parameter.value);
      checkpoint.first_moments[parameter.name] = ToArray(parameter.first_moment);
      checkpoint.second_moments[parameter.name] = ToArray(parameter.second_moment);
    }
  }
  return checkpoint;
}

void TrainingRun::Save() {
  RequireSoundness();
  WriteCheckpoint(File("checkpoint.h5"), MakeCheckpoint());
}

void TrainingRun::Restore(const Checkpoint& checkpoint) {
  const torch::NoGradGuard no_grad;
  const std::string file = File("checkpoint.h5").string();
  if (checkpoint.info.data_fingerprints != info_.data_fingerprints) {
    ThrowBadInput({file, "data fingerprints", fmt::format("{}", fmt::join(checkpoint.info.data_fingerprints, " ")),
                   fmt::format("{}", fmt::join(info_.data_fingerprints, " ")),
                   "resume with the data the run was started with, or train into another folder"});
  }
  LoadParameters(lifter_, checkpoint.parameters, file);
  for (Adam* adam : {&adam_, &perspective_adam_}) {
    for (Adam::Parameter& parameter : adam->parameters()) {
      const auto restore = [&](const NamedArrays& arrays, torch::Tensor& tensor) {
        const auto found = arrays.find(parameter.name);
        if (found == arrays.end() || static_cast<std::int64_t>(found->second.values.size()) != tensor.numel()) {
          ThrowBadInput(
              {file, parameter.name, "the optimiser's state", "none that fits", "the file is damaged: train again"});
        }
        tensor.copy_(ToTensor(found->second).view(tensor.sizes()));
      };
      restore(checkpoint.parameters, parameter.value);
      restore(checkpoint.first_moments, parameter.first_moment);
      restore(checkpoint.second_moments, parameter.second_moment);
    }
  }
  step_ = checkpoint.info.steps;
  adam_.set_step_count(step_);
  perspective_adam_.set_step_count(checkpoint.perspective_steps);
  info_.mirror = checkpoint.info.mirror;
  sums_ = checkpoint.sums;
  if (step_ > warmup_steps()) FreePerspectiveIfDecided();
}

std::vector<const TrainingFrame*> TrainingRun::BatchOf(std::int64_t step) {
  if (order_epoch_ != epoch_of(step)) {
    order_epoch_ = epoch_of(step);
    order_ = Rng(options_.seed, {kFrameOrder, static_cast<std::uint64_t>(order_epoch_)})
                 .Permutation(split_.training.frames.size());
  }
  const auto batch = static_cast<std::size_t>(options_.batch_frames);
  const std::size_t first = static_cast<std::size_t>(step % schedule_.steps_per_epoch) * batch;
  std::vector<const TrainingFrame*> frames;
  for (std::size_t i = first; i < std::min(first + batch, order_.size()); ++i) {
    frames.push_back(&split_.training.frames[order_[i]]);
  }
  return frames;
}

Losses TrainingRun::BatchLosses(std::int64_t step) {
  const std::vector<const TrainingFrame*> frames = BatchOf(step);
  if (is_supervised()) {
    Rng rng(options_.seed, {kAugmentation, static_cast<std::uint64_t>(step)});
    const RowChange change = [&](int row, const TrainingRow& copy) { augmentation_.Change(row, rng, copy); };
    const BatchTensors batch =
        GatherBatch(split_.training, frames, device_, augmentation_.any() ? change : RowChange());
    return ComputeSupervisedLoss(lifter_->forward(LifterInput(batch)), batch, root_);
  }
  Rng permutations(options_.seed, {kPermutations, static_cast<std::uint64_t>(step)});
  const BatchPairs pairs =
      MakeBatchPairs(frames, split_.training.static_captures, options_.camera_consistency == "static",
                     [&](std::size_t count) { return permutations.Permutation(count); });
  const BatchTensors batch = GatherBatch(split_.training, frames, device_);
  const LossWeights weights{1.0, options_.view_weight, options_.camera_weight};
  return ComputeLosses(lifter_->forward(LifterInput(batch)), batch, pairs, weights, PerspectiveInLosses(), root_);
}

void TrainingRun::TakeStep() {
  const Losses losses = BatchLosses(step_);
  const double total = losses.total.item<double>();
  if (!std::isfinite(total)) StopAtBadLoss(fmt::format("the loss became {} at step {}", total, step_ + 1));
  losses.total.backward();

  const double factor = LearningRateFactor(options_, schedule_, step_);
  adam_.Step(options_.learning_rate * factor);
  if (perspective_is_free_) {
    perspective_adam_.Step(options_.perspective_learning_rate);
    // A negative factor belongs to the mirrored solution.
    const torch::NoGradGuard no_grad;
    perspective_.clamp_(0.0);
  }
  sums_.reprojection += losses.reprojection.item<double>();
  sums_.view += losses.view.item<double>();
  sums_.camera += losses.camera.item<double>();
  sums_.total += total;
  ++sums_.steps;
  ++step_;
}

/// Only a state whose own loss is a number is worth keeping: an update may have spoiled what the loss before it did not
/// show.
void TrainingRun::RequireSoundness() {
  const torch::NoGradGuard no_grad;
  const double loss = BatchLosses(std::min(step_, schedule_.steps() - 1)).total.item<double>();
  bool is_finite = std::isfinite(loss);
  for (const Adam::Parameter& parameter : adam_.parameters()) {
    is_finite = is_finite && torch::isfinite(parameter.value).all().item<bool>();
  }
  if (!is_finite)
    StopAtBadLoss(
        fmt::format("the network's weights or its loss ({}) are no longer numbers after step {}", loss, step_));
}

void TrainingRun::StopAtBadLoss(const std::string& what) {
  std::string kept = "no good model was made";
  if (fs::exists(File("checkpoint.h5"))) {
    Checkpoint last_good = ReadCheckpoint(File("checkpoint.h5"));
    last_good.parameters.erase(kPerspectiveName);
    // An untrained network is no reason to replace a model that an earlier run left here.
    if (last_good.info.steps > 0 || !fs::exists(File("model.cpm"))) {
      WriteModelFile(File("model.cpm"), {last_good.info, last_good.parameters});
    }
    kept = fmt::format("the last good model, of step {}, is in {}", last_good.info.steps, File("model.cpm").string());
  }
  ThrowComputation("{} of {}; {}; try again with a smaller --set learning_rate", what, schedule_.steps(), kept);
}

void TrainingRun::FreePerspectiveIfDecided() {
  perspective_is_free_ = wants_perspective() && info_.mirror.decision != "undecided";
}

void TrainingRun::Mirror() {
  lifter_->Mirror();
  for (Adam::Parameter& parameter : adam_.parameters()) lifter_->MirrorRows(parameter.name, parameter.first_moment);
}

void TrainingRun::DecideMirror() {
  if (is_supervised()) {
    info_.mirror = {options_.supervision == "truth" ? "known from the truth" : "known from the solution", 0.0, 0.0};
    return;
  }
  const PerspectiveSlope slope = MeasurePerspectiveSlope(lifter_, split_.training, root_, device_);
  const bool decided_before = info_.mirror.decision != "undecided";
  if (options_.mirror != "auto") {
    if (!decided_before) {
      if (options_.mirror == "flip") Mirror();
      info_.mirror = {options_.mirror == "flip" ? "flipped by request" : "kept by request", slope.slope,
                      slope.standard_error};
      LogInfo("mirror: {}; perspective {}", info_.mirror.decision, slope.Describe());
    }
    return;
  }
  if (!slope.is_sure() && decided_before) {
    LogInfo("mirror: {} at the warm-up, which stands ({} now tells too little)", info_.mirror.decision,
            slope.Describe());
    return;
  }
  if (!slope.is_sure()) {
    info_.mirror = {"undecided", slope.slope, slope.standard_error};
    LogWarning(
        "mirror: perspective is too weak to tell the pose from its depth mirror ({}, {:.1f} standard errors; {} are "
        "needed), or training found no good solution; try another --seed, or look at the poses and train again with "
        "--mirror keep or --mirror flip",
        slope.Describe(), slope.sureness(), PerspectiveSlope::kSure);
    return;
  }
  if (slope.is_mirrored()) Mirror();
  if (!decided_before || slope.is_mirrored()) {
    info_.mirror = {slope.is_mirrored() ? "flipped" : "kept", slope.slope, slope.standard_error};
  }
  const char* what = "right, so kept";
  if (decided_before) what = "confirmed after training";
  if (slope.is_mirrored()) what = "mirrored, so flipped";
  LogInfo("mirror: {} ({}, {:.1f} standard errors; negative is right)", what, slope.Describe(), slope.sureness());
}

std::optional<double> TrainingRun::ValidationLoss() {
  const TrainingSet& set = split_.validation;
  if (set.frames.empty()) return std::nullopt;
  const torch::NoGradGuard no_grad;
  constexpr std::size_t kChunk = 512;
  double sum = 0.0;
  for (std::size_t first = 0; first < set.frames.size(); first += kChunk) {
    std::vector<const TrainingFrame*> frames;
    for (std::size_t n = first; n < std::min(first + kChunk, set.frames.size()); ++n) frames.push_back(&set.frames[n]);
    const BatchTensors batch = GatherBatch(set, frames, device_);
    const LifterOutput output = lifter_->forward(LifterInput(batch));
    const Losses losses =
        is_supervised() ? ComputeSupervisedLoss(output, batch, root_)
                        : ComputeLosses(output, batch, MakeBatchPairs(frames, set.static_captures, false, nullptr),
                                        {1.0, options_.view_weight, 0.0}, PerspectiveInLosses(), root_);
    sum += losses.total.item<double>() * static_cast<double>(frames.size());
  }
  return sum / static_cast<double>(set.frames.size());
}

void TrainingRun::EndEpoch() {
  const auto now = std::chrono::steady_clock::now();
  const auto steps = static_cast<double>(std::max<std::int64_t>(1, sums_.steps));
  Json line;
  line["epoch"] = epoch();
  line["step"] = step_;
  line["learning_rate"] = options_.learning_rate * LearningRateFactor(options_, schedule_, step_ - 1);
  line["loss"] = sums_.total / steps;
  if (!is_supervised()) {
    line["reprojection"] = sums_.reprojection / steps;
    line["view"] = sums_.view / steps;
    line["camera"] = sums_.camera / steps;
  }
  const std::optional<double> validation = ValidationLoss();
  line["validation"] = validation ? Json(*validation) : Json(nullptr);
  line["perspective"] = perspective_.item<double>();
  line["seconds"] = std::chrono::duration<double>(now - epoch_start_).count();
  AppendLine(File("metrics.jsonl"), line.dump());
  LogToFileOnly(fmt::format("epoch {}/{}: loss {:.4f}, validation {:.4f}", epoch(), schedule_.epochs,
                            sums_.total / steps, validation.value_or(NAN)));
  epoch_start_ = now;
  sums_ = {};
}

std::string TrainingRun::DescribeLoss() const {
  const auto steps = static_cast<double>(std::max<std::int64_t>(1, sums_.steps));
  if (is_supervised()) return fmt::format("loss {:.4f}", sums_.total / steps);
  return fmt::format("loss {:.3f} (reprojection {:.3f}, view {:.3f}, camera {:.3f})", sums_.total / steps,
                     sums_.reprojection / steps, sums_.view / steps, sums_.camera / steps);
}

int TrainingRun::Run() {
  using Clock = std::chrono::steady_clock;
  const InterruptGuard interrupt;
  Progress progress("step", schedule_.steps(), step_);
  Clock::time_point last_save = Clock::now();
  while (step_ < schedule_.steps()) {
    if (wants_perspective() && step_ == warmup_steps()) {
      DecideMirror();
      FreePerspectiveIfDecided();
    }
    TakeStep();
    if (progress.IsDue()) {
      progress.Update(step_, DescribeLoss());
    }
    if (step_ % schedule_.steps_per_epoch == 0) EndEpoch();
    const bool is_due = std::chrono::duration<double>(Clock::now() - last_save).count() >= options_.checkpoint_seconds;
    if (is_due || interrupt.signal() != 0 || step_ == schedule_.steps()) {
      Save();
      last_save = Clock::now();
    }
    if (interrupt.signal() != 0 && step_ < schedule_.steps()) return interrupt.signal();
  }
  return 0;
}

TrainReport TrainingRun::Finish() {
  RequireSoundness();
  DecideMirror();
  TrainReport report;
  report.validation_loss = ValidationLoss();
  info_.steps = step_;
  info_.perspective = perspective_.item<double>();
  WriteModelFile(File("model.cpm"), {info_, ParametersOf(lifter_)});
  report.model = info_;
  return report;
}

void DescribeStart(const TrainingRun& run, const TrainOptions& options) {
  const TrainingSplit& split = run.split();
  const Schedule& schedule = run.schedule();
  const std::size_t moving = static_cast<std::size_t>(
      std::count(split.training.static_captures.begin(), split.training.static_captures.end(), std::uint8_t{0}));
  LogInfo("{} frames to train on, {} held out, {} left out ({})", split.training.frames.size(),
          split.validation.frames.size(), split.frames_left_out,
          options.supervision == "none" ? "seen by fewer than two cameras" : "no 3D pose to learn from");
  LogInfo("preset {}, width {}, {} epochs of {} steps on {} ({} threads)", options.preset, options.width,
          schedule.epochs, schedule.steps_per_epoch, options.device, ThreadCount());
  if (options.epochs == 0 && schedule.epochs != options.default_epochs) {
    LogInfo("a small recording: {} epochs in place of {}, so that {} steps are taken (--epochs overrides)",
            schedule.epochs, options.default_epochs, schedule.steps());
  }
  if (options.camera_consistency == "static" && moving > 0) {
    LogInfo("camera consistency is left out for {} of {} captures, whose cameras move", moving,
            split.training.static_captures.size());
  }
}

}  // namespace

std::optional<TrainOptions> RecordedOptions(const fs::path& run_folder) {
  const fs::path path = run_folder / "checkpoint.h5";
  if (!fs::exists(path)) return std::nullopt;
  return TrainOptions::FromJson(ReadCheckpoint(path).info.options, path.string());
}

TrainReport Train(const TrainJob& job) {
  const auto start = std::chrono::steady_clock::now();
  job.options.Validate();
  RequireDevice(job.options.device);
  SetThreadCount(job.options.threads);
  WarnAboutSlowLinearAlgebra();
  RequireSuitableData(job);
  TrainingSplit split = MakeTrainingSplit(job.datasets, job.options.validation, RowFormOf(job.options));
  PrepareRunFolder(job.run_folder, job.resume, job.overwrite);
  TrainingRun run(job, std::move(split));
  if (!job.resume) {
    // An earlier model and checkpoint stay until this run replaces them by its own.
    for (const char* name : {"metrics.jsonl", "train.log"}) fs::remove(job.run_folder / name);
  }
  const LogFile log(job.run_folder / "train.log");
  DescribeStart(run, job.options);
  const fs::path checkpoint_path = job.run_folder / "checkpoint.h5";
  if (job.resume && fs::exists(checkpoint_path)) {
    const Checkpoint checkpoint = ReadCheckpoint(checkpoint_path);
    run.Restore(checkpoint);
    DropLaterMetrics(job.run_folder / "metrics.jsonl", checkpoint.info.steps);
    LogInfo("going on after step {}", checkpoint.info.steps);
  } else {
    run.Save();
  }
  TrainReport report;
  const int signal = run.Run();
  if (signal == 0) {
    report = run.Finish();
  } else {
    report.interrupted_by = signal;
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace canonpose
