#include "canonpose/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/version.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/augmentation.h"
#include "canonpose/train/batch_order.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/data_checks.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/mirror.h"
#include "canonpose/train/optimiser_state.h"
#include "canonpose/train/restarts.h"
#include "canonpose/train/run_folder.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/streams.h"
#include "canonpose/train/training_set.h"
#include "canonpose/train/trap.h"
#include "canonpose/train/triangulated_targets.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr const char* kPerspectiveName = "perspective";

/// Frames that restarts are compared on.
constexpr std::size_t kComparedFrames = 2000;

/// The state of a run and the steps of its life; Train() below is the plot.
class TrainingRun {
 public:
  TrainingRun(const TrainJob& job, TrainingSplit split);

  [[nodiscard]] const TrainingSplit& split() const { return split_; }
  [[nodiscard]] const Schedule& schedule() const { return schedule_; }
  void Restore(const Checkpoint& checkpoint);
  void Save();
  /// False where it was asked to stop before the end; the checkpoint is saved.
  bool Run(LogFile& log);
  TrainReport Finish();

 private:
  [[nodiscard]] bool is_supervised() const { return options_.is_supervised(); }
  [[nodiscard]] RestartPlan plan() const { return {options_.restarts, options_.restart_steps, schedule_.steps()}; }
  /// Seed of what is running: that of a restart where there are several.
  [[nodiscard]] std::uint64_t seed() const { return RestartSeed(options_.seed, restarts_.running); }
  [[nodiscard]] bool wants_perspective() const { return options_.perspective == PerspectiveForm::kLearned; }
  [[nodiscard]] std::int64_t warmup_steps() const {
    return static_cast<std::int64_t>(options_.perspective_warmup * static_cast<double>(schedule_.steps()));
  }
  [[nodiscard]] int epoch_of(std::int64_t step) const { return static_cast<int>(step / schedule_.steps_per_epoch); }
  [[nodiscard]] int epoch() const { return epoch_of(step_); }
  /// The factor as the losses take it; undefined while projection is weak perspective.
  [[nodiscard]] torch::Tensor PerspectiveInLosses() const {
    return perspective_is_free_ ? perspective_ : torch::Tensor();
  }

  void TakeStep();
  Losses BatchLosses(std::int64_t step);
  /// Without supervision. May change the batch's confidences.
  Losses LossesOfViews(BatchTensors& batch, const BatchPairs& pairs, const LossWeights& weights);
  void RequireSoundness();
  [[noreturn]] void StopAtBadLoss(const std::string& what);
  void StartAfresh();
  void EndRestart();
  void RestoreState(const Checkpoint& checkpoint);
  void EndEpoch(LogFile& log);
  [[nodiscard]] std::string DescribeLoss() const;
  /// Over every n-th frame of a set, about `frames_wanted` of them, without camera consistency.
  Losses MeanLossesOf(const TrainingSet& set, std::size_t frames_wanted);
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
  Batches batches_;
  Augmentation augmentation_;
  int root_;
  torch::Device device_;
  ModelInfo info_;
  std::shared_ptr<LiftingNetwork> network_;
  torch::Tensor perspective_;
  Adam adam_;
  Adam perspective_adam_;
  bool perspective_is_free_ = false;
  EpochSums sums_;
  std::int64_t step_ = 0;
  RestartState restarts_;
  std::chrono::steady_clock::time_point epoch_start_ = std::chrono::steady_clock::now();
};

/// What the poses to learn came from, in a sentence.
const char* SourceOfTargets(Supervision supervision) {
  if (supervision == Supervision::kTruth) return "truth";
  return supervision == Supervision::kSolved ? "solution" : "calibration";
}

void InitialiseNetwork(LiftingNetwork& network, const TrainOptions& options, std::uint64_t seed) {
  network.Initialise(Rng(seed, {stream::kInitialisation}).Bits());
  if (options.rotation_spread != 1.0) network.ScaleRotations(options.rotation_spread);
}

std::shared_ptr<LiftingNetwork> NewNetwork(const ModelInfo& info, const TrainOptions& options, torch::Device device) {
  std::shared_ptr<LiftingNetwork> network = MakeNetwork(info);
  InitialiseNetwork(*network, options, options.seed);
  network->to(device);
  network->eval();
  return network;
}

/// What the model file says of a job before anything is trained.
ModelInfo DescribeModel(const TrainJob& job) {
  const TrainOptions& options = job.options;
  ModelInfo info;
  info.program_version = ProgramVersion();
  info.skeleton = job.datasets.front().skeleton;
  info.source = job.datasets.front().source;
  info.network = NetworkOf(options.network);
  info.width = options.width;
  info.rotation = options.rotation;
  info.input = InputFormOf(options);
  info.preset = options.preset;
  info.options = options.ToJson(/*only_what_changes_results=*/true);
  info.seed = options.seed;
  info.data_files = job.data_files;
  info.morph = job.morph;
  for (const Dataset& dataset : job.datasets) info.data_fingerprints.push_back(FingerprintOf(dataset, options));
  return info;
}

TrainingRun::TrainingRun(const TrainJob& job, TrainingSplit split)
    : options_(job.options),
      run_folder_(job.run_folder),
      split_(std::move(split)),
      schedule_(MakeSchedule(options_, split_.training.frames.size())),
      batches_(split_.training, options_, schedule_),
      augmentation_(job.datasets, split_.training, options_),
      root_(job.datasets.front().skeleton.root),
      device_(options_.device == "cuda" ? torch::kCUDA : torch::kCPU),
      info_(DescribeModel(job)),
      network_(NewNetwork(info_, options_, device_)),
      perspective_(torch::zeros({}, torch::TensorOptions(device_)).requires_grad_()),
      adam_(NamedParameters(*network_), options_.weight_decay),
      perspective_adam_({{kPerspectiveName, perspective_}}, 0.0) {}

Checkpoint TrainingRun::MakeCheckpoint() const {
  Checkpoint checkpoint{info_, sums_, perspective_adam_.step_count(), {}, {}, {}, {}};
  checkpoint.info.steps = step_;
  checkpoint.info.perspective = perspective_.item<double>();
  for (const Adam* adam : {&adam_, &perspective_adam_}) StoreOptimiser(*adam, checkpoint);
  checkpoint.parameters.merge(StatisticsOf(*network_));
  return checkpoint;
}

void TrainingRun::Save() {
  RequireSoundness();
  Checkpoint checkpoint = MakeCheckpoint();
  checkpoint.restarts = restarts_;
  WriteCheckpoint(File("checkpoint.h5"), checkpoint);
}

void TrainingRun::Restore(const Checkpoint& checkpoint) {
  const std::string file = File("checkpoint.h5").string();
  if (checkpoint.info.data_fingerprints != info_.data_fingerprints) {
    ThrowBadInput({file, "data fingerprints", fmt::format("{}", fmt::join(checkpoint.info.data_fingerprints, " ")),
                   fmt::format("{}", fmt::join(info_.data_fingerprints, " ")),
                   "resume with the data the run was started with, or train into another folder"});
  }
  restarts_ = checkpoint.restarts;
  RestoreState(checkpoint);
}

void TrainingRun::RestoreState(const Checkpoint& checkpoint) {
  const std::string file = File("checkpoint.h5").string();
  LoadParameters(*network_, checkpoint.parameters, file);
  for (Adam* adam : {&adam_, &perspective_adam_}) RestoreOptimiser(checkpoint, file, *adam);
  step_ = checkpoint.info.steps;
  adam_.set_step_count(step_);
  perspective_adam_.set_step_count(checkpoint.perspective_steps);
  info_.mirror = checkpoint.info.mirror;
  sums_ = checkpoint.sums;
  perspective_is_free_ = false;
  if (step_ > warmup_steps()) FreePerspectiveIfDecided();
}

Losses TrainingRun::BatchLosses(std::int64_t step) {
  const auto [frames, windows] = batches_.At(step, seed());
  if (is_supervised()) {
    Rng rng(seed(), {stream::kAugmentation, static_cast<std::uint64_t>(step)});
    const RowChange change = [&](int row, const TrainingRow& copy) { augmentation_.Change(row, rng, copy); };
    const BatchTensors batch =
        GatherBatch(split_.training, frames, device_, augmentation_.any() ? change : RowChange());
    return ComputeSupervisedLoss(network_->forward(LifterInput(batch)), batch, root_);
  }
  BatchTensors batch = GatherBatch(split_.training, frames, device_);
  Rng permutations(seed(), {stream::kPermutations, static_cast<std::uint64_t>(step)});
  const bool is_static = options_.camera_consistency == CameraConsistency::kStatic;
  const double left = is_static ? 1.0 : WindowLeft(options_, schedule_, step);
  const BatchPairs pairs = MakeBatchPairs(
      frames, split_.training.static_captures, is_static || (left > 0.0 && !windows.empty()),
      [&](std::size_t count) { return permutations.Permutation(count); }, windows);
  const LossWeights weights{1.0, options_.view_weight, options_.camera_weight * left};
  return LossesOfViews(batch, pairs, weights);
}

Losses TrainingRun::LossesOfViews(BatchTensors& batch, const BatchPairs& pairs, const LossWeights& weights) {
  const LifterOutput output = network_->forward(LifterInput(batch));
  if (!options_.loss_confidences) WeighSeenJointsAlike(batch);
  return ComputeLosses(output, batch, pairs, weights, PerspectiveInLosses(), root_, options_.consistency);
}

void TrainingRun::TakeStep() {
  // Dropout is LibTorch's own: its generator is set anew, so that a step depends on its number alone.
  torch::manual_seed(Rng(seed(), {stream::kDropout, static_cast<std::uint64_t>(step_)}).Bits());
  network_->train();
  const Losses losses = BatchLosses(step_);
  network_->eval();
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
  ThrowComputation("{} of {}; {}; try again with a smaller `learning_rate`", what, schedule_.steps(),
                   KeepLastGoodModel(run_folder_, {kPerspectiveName}));
}

void TrainingRun::FreePerspectiveIfDecided() {
  perspective_is_free_ = wants_perspective() && info_.mirror.decision != "undecided";
}

void TrainingRun::Mirror() {
  network_->Mirror();
  for (Adam::Parameter& parameter : adam_.parameters()) network_->MirrorRows(parameter.name, parameter.first_moment);
}

void TrainingRun::DecideMirror() {
  if (is_supervised()) {
    info_.mirror = {fmt::format("known from the {}", SourceOfTargets(options_.supervision)), 0.0, 0.0};
    return;
  }
  const PerspectiveSlope slope = MeasurePerspectiveSlope(*network_, split_.training, root_, device_);
  if (UpdateMirrorDecision(slope, options_.mirror, info_.mirror)) Mirror();
}

Losses TrainingRun::MeanLossesOf(const TrainingSet& set, std::size_t frames_wanted) {
  const std::size_t stride = (set.frames.size() + frames_wanted - 1) / frames_wanted;
  return MeanLosses(set, stride, [&](const std::vector<const TrainingFrame*>& frames) {
    BatchTensors batch = GatherBatch(set, frames, device_);
    if (is_supervised()) return ComputeSupervisedLoss(network_->forward(LifterInput(batch)), batch, root_);
    return LossesOfViews(batch, MakeBatchPairs(frames, set.static_captures, false, nullptr),
                         {1.0, options_.view_weight, 0.0});
  });
}

std::optional<double> TrainingRun::ValidationLoss() {
  if (split_.validation.frames.empty()) return std::nullopt;
  return MeanLossesOf(split_.validation, split_.validation.frames.size()).total.item<double>();
}

void TrainingRun::StartAfresh() {
  InitialiseNetwork(*network_, options_, seed());
  perspective_.detach().zero_();
  for (Adam* adam : {&adam_, &perspective_adam_}) ResetOptimiser(*adam);
  perspective_is_free_ = false;
  info_.mirror = {};
  sums_ = {};
  step_ = 0;
}

void TrainingRun::EndRestart() {
  RequireSoundness();
  const double loss = MeanLossesOf(split_.training, kComparedFrames).view.item<double>();
  AppendLine(File("metrics.jsonl"), Json{{"restart", restarts_.running}, {"seed", seed()}, {"view", loss}}.dump());
  LogInfo("restart {} of {}: loss of view mixing {:.4f}", restarts_.running + 1, options_.restarts, loss);
  restarts_.losses.push_back(loss);
  if (BestRestart(restarts_.losses) == restarts_.running) {
    restarts_.best = std::make_shared<const Checkpoint>(MakeCheckpoint());
  }
  if (plan().IsRunning(restarts_)) {
    ++restarts_.running;
    StartAfresh();
    return;
  }
  restarts_.running = BestRestart(restarts_.losses);
  RestoreState(*std::exchange(restarts_.best, nullptr));
  LogInfo("going on with restart {}", restarts_.running + 1);
}

void TrainingRun::EndEpoch(LogFile& log) {
  const auto now = std::chrono::steady_clock::now();
  if (plan().IsRunning(restarts_)) {  // these epochs are not the run's unless it is chosen, and it has the like to come
    epoch_start_ = now;
    sums_ = {};
    return;
  }
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
  log.Write(fmt::format("epoch {}/{}: loss {:.4f}, validation {:.4f}", epoch(), schedule_.epochs, sums_.total / steps,
                        validation.value_or(NAN)));
  epoch_start_ = now;
  sums_ = {};
}

std::string TrainingRun::DescribeLoss() const {
  const auto steps = static_cast<double>(std::max<std::int64_t>(1, sums_.steps));
  if (is_supervised()) return fmt::format("loss {:.4f}", sums_.total / steps);
  return fmt::format("loss {:.3f} (reprojection {:.3f}, view {:.3f}, camera {:.3f})", sums_.total / steps,
                     sums_.reprojection / steps, sums_.view / steps, sums_.camera / steps);
}

bool TrainingRun::Run(LogFile& log) {
  Progress progress("step", plan().StepsInAll(), plan().StepsDone(restarts_, step_));
  Clock::time_point last_save = Clock::now();
  while (step_ < schedule_.steps()) {
    if (wants_perspective() && step_ == warmup_steps()) {
      DecideMirror();
      FreePerspectiveIfDecided();
    }
    TakeStep();
    if (progress.IsDue()) {
      progress.Update(plan().StepsDone(restarts_, step_), DescribeLoss());
    }
    if (step_ % schedule_.steps_per_epoch == 0) EndEpoch(log);
    if (plan().IsRunning(restarts_) && step_ == plan().steps()) EndRestart();
    const bool is_due = std::chrono::duration<double>(Clock::now() - last_save).count() >= options_.checkpoint_seconds;
    const bool must_stop = step_ < schedule_.steps() && StopRequested();
    if (is_due || must_stop || step_ == schedule_.steps()) {
      Save();
      last_save = Clock::now();
    }
    if (must_stop) return false;
  }
  return true;
}

TrainReport TrainingRun::Finish() {
  RequireSoundness();
  DecideMirror();
  TrainReport report;
  report.validation_loss = ValidationLoss();
  if (!is_supervised())
    info_.trap = ReportTrap(MeasureTrapSigns(*network_, split_.training, root_, device_), info_.input);
  info_.steps = step_;
  info_.perspective = perspective_.item<double>();
  WriteModelFile(File("model.cpm"), {info_, ParametersOf(*network_)});
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
          !options.is_supervised() ? "seen by fewer than two cameras" : "no 3D pose to learn from");
  LogInfo("preset {}, width {}, {} epochs of {} steps on {} ({} threads)", options.preset, options.width,
          schedule.epochs, schedule.steps_per_epoch, options.device, ThreadCount());
  if (options.epochs == 0 && schedule.epochs != options.default_epochs) {
    LogInfo("a small recording: {} epochs in place of {}, so that {} steps are taken (`epochs` overrides)",
            schedule.epochs, options.default_epochs, schedule.steps());
  }
  if (options.camera_consistency == CameraConsistency::kStatic && moving > 0) {
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

TrainReport Train(const TrainJob& given) {
  const auto start = std::chrono::steady_clock::now();
  given.options.Validate();
  std::optional<TrainJob> triangulated;
  if (given.options.supervision == Supervision::kTriangulated) {
    triangulated = given;
    for (Dataset& dataset : triangulated->datasets) LearnFromTriangulation(dataset);
  }
  const TrainJob& job = triangulated ? *triangulated : given;
  RequireDevice(job.options.device);
  const ThreadScope threads(job.options.threads);
  WarnAboutSlowLinearAlgebra();
  RequireSuitableData(job);
  TrainingSplit split = MakeTrainingSplit(job.datasets, job.options.validation, RowFormOf(job.options));
  PrepareRunFolder(job.run_folder, job.resume, job.overwrite);
  TrainingRun run(job, std::move(split));
  if (!job.resume) {
    // An earlier model and checkpoint stay until this run replaces them by its own.
    for (const char* name : {"metrics.jsonl", "train.log"}) fs::remove(job.run_folder / name);
  }
  LogFile log(job.run_folder / "train.log");
  DescribeStart(run, job.options);
  const fs::path checkpoint_path = job.run_folder / "checkpoint.h5";
  if (job.resume && fs::exists(checkpoint_path)) {
    const Checkpoint checkpoint = ReadCheckpoint(checkpoint_path);
    run.Restore(checkpoint);
    DropLaterMetrics(job.run_folder / "metrics.jsonl", checkpoint.info.steps,
                     static_cast<int>(checkpoint.restarts.losses.size()));
    LogInfo("going on after step {}", checkpoint.info.steps);
  } else {
    run.Save();
  }
  TrainReport report;
  report.stopped = !run.Run(log);
  if (!report.stopped) report = run.Finish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace canonpose
