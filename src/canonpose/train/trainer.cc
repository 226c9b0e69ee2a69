#include "canonpose/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/version.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/augmentation.h"
#include "canonpose/train/data_checks.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/objective.h"
#include "canonpose/train/optimiser_state.h"
#include "canonpose/train/restarts.h"
#include "canonpose/train/run_folder.h"
#include "canonpose/train/schedule.h"
#include "canonpose/train/streams.h"
#include "canonpose/train/training_loop.h"
#include "canonpose/train/training_set.h"
#include "canonpose/train/triangulated_targets.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Frames that restarts are compared on.
constexpr std::size_t kComparedFrames = 2000;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void InitialiseNetwork(LiftingNetwork& network, const TrainOptions& options, std::uint64_t seed) {
  network.Initialise(Rng(seed, {stream::kInitialisation}).Bits());
  if (options.rotation_spread != 1.0) network.ScaleRotations(options.rotation_spread);
}

LifterState NewLifter(const ModelInfo& info, const TrainOptions& options) {
  const torch::Device device(options.device == "cuda" ? torch::kCUDA : torch::kCPU);
  std::shared_ptr<LiftingNetwork> network = MakeNetwork(info);
  InitialiseNetwork(*network, options, options.seed);
  network->to(device);
  network->eval();
  Adam adam(NamedParameters(*network), options.weight_decay);
  return {std::move(network), std::move(adam), device, info.skeleton.root};
}

/// What the model file says about a job before anything is trained.
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
  if (info.morph) info.source.morph.clear();  // the model brings it
  for (const Dataset& dataset : job.datasets) info.data_fingerprints.push_back(FingerprintOf(dataset, options));
  return info;
}

/// The training of a lifter; of several restarts where there are some, and then of the best of them.
class LifterTraining : public TrainingTask {
 public:
  LifterTraining(const TrainJob& job, TrainingSplit split, RunFolder& folder)
      : options_(job.options),
        folder_(folder),
        split_(std::move(split)),
        schedule_(MakeSchedule(options_, split_.training.frames.size())),
        info_(DescribeModel(job)),
        lifter_(NewLifter(info_, options_)),
        objective_(options_.is_supervised()
                       ? MakeSupervisedObjective(job.datasets, split_.training, options_, schedule_, lifter_)
                       : MakeViewObjective(split_.training, options_, schedule_, lifter_)),
        state_{0, LossSums(lifter_.device)} {}

  [[nodiscard]] LoopState& state() override { return state_; }
  [[nodiscard]] std::int64_t steps() const override { return schedule_.steps(); }
  [[nodiscard]] std::int64_t steps_per_epoch() const override { return schedule_.steps_per_epoch; }
  [[nodiscard]] const Adam& optimiser() const override { return lifter_.adam; }

  [[nodiscard]] bool IsDecisionDue() override { return objective_->IsDecisionDue(state_.step); }
  void Decide() override { objective_->Decide(); }

  Losses Forward() override {
    // Dropout draws from LibTorch's own generator, which is seeded here so that a step depends on its number alone.
    torch::manual_seed(Rng(seed(), {stream::kDropout, static_cast<std::uint64_t>(state_.step)}).Bits());
    lifter_.network->train();
    Losses losses = objective_->OfStep(state_.step, seed());
    lifter_.network->eval();
    return losses;
  }

  void Update() override {
    lifter_.adam.Step(options_.learning_rate * LearningRateFactor(options_, schedule_, state_.step));
    objective_->Update();
  }

  double ProbeLoss() override {
    const torch::NoGradGuard no_grad;
    return objective_->OfStep(std::min(state_.step, steps() - 1), seed()).total.item<double>();
  }

  void EndEpoch(const EpochSums& sums) override;
  [[nodiscard]] bool IsStageOver() override { return IsRestarting() && state_.step == plan().steps(); }
  void EndStage() override;

  [[nodiscard]] Checkpoint MakeCheckpoint() override {
    Checkpoint checkpoint = MakeCheckpointOfRestart();
    checkpoint.restarts = restarts_;
    return checkpoint;
  }
  void Restore(const Checkpoint& checkpoint, const std::string& file) override;

  [[nodiscard]] std::int64_t StepsDone() override { return plan().StepsDone(restarts_, state_.step); }
  [[nodiscard]] std::int64_t StepsInAll() override { return plan().StepsInAll(); }
  [[nodiscard]] std::string DescribeLoss(const EpochSums& sums) const override;

  void DescribeStart() const;
  /// After the last step.
  TrainReport Finish();

 private:
  [[nodiscard]] RestartPlan plan() const { return {options_.restarts, options_.restart_steps, steps()}; }
  [[nodiscard]] bool IsRestarting() const { return plan().IsRunning(restarts_); }
  /// That of the running restart, where there are several.
  [[nodiscard]] std::uint64_t seed() const { return RestartSeed(options_.seed, restarts_.running); }

  void StartAfresh();
  [[nodiscard]] Checkpoint MakeCheckpointOfRestart();
  void RestoreRestart(const Checkpoint& checkpoint, const std::string& file);
  /// Over every n-th frame of a set, about `frames_wanted` of them.
  Losses MeanLossesOf(const TrainingSet& set, std::size_t frames_wanted);
  std::optional<double> ValidationLoss();

  TrainOptions options_;
  RunFolder& folder_;
  TrainingSplit split_;
  Schedule schedule_;
  ModelInfo info_;
  LifterState lifter_;
  std::unique_ptr<Objective> objective_;
  LoopState state_;
  RestartState restarts_;
  Clock::time_point epoch_start_ = Clock::now();
};

void LifterTraining::StartAfresh() {
  InitialiseNetwork(*lifter_.network, options_, seed());
  ResetOptimiser(lifter_.adam);
  objective_->Reset();
  state_.step = 0;
  state_.sums.Set({});
}

Checkpoint LifterTraining::MakeCheckpointOfRestart() {
  Checkpoint checkpoint;
  checkpoint.info = info_;
  checkpoint.info.steps = state_.step;
  checkpoint.sums = state_.sums.Read();
  objective_->Describe(checkpoint.info);
  StoreOptimiser(lifter_.adam, checkpoint);
  checkpoint.parameters.merge(StatisticsOf(*lifter_.network));
  objective_->Store(checkpoint);
  return checkpoint;
}

void LifterTraining::Restore(const Checkpoint& checkpoint, const std::string& file) {
  if (checkpoint.info.data_fingerprints != info_.data_fingerprints) {
    ThrowBadInput({file, "data fingerprints", fmt::format("{}", fmt::join(checkpoint.info.data_fingerprints, " ")),
                   fmt::format("{}", fmt::join(info_.data_fingerprints, " ")),
                   "resume with the data the run was started with, or train into another folder"});
  }
  restarts_ = checkpoint.restarts;
  RestoreRestart(checkpoint, file);
}

void LifterTraining::RestoreRestart(const Checkpoint& checkpoint, const std::string& file) {
  LoadParameters(*lifter_.network, checkpoint.parameters, file);
  RestoreOptimiser(checkpoint, file, lifter_.adam);
  lifter_.adam.set_step_count(checkpoint.info.steps);
  objective_->Restore(checkpoint, file);
  state_.step = checkpoint.info.steps;
  state_.sums.Set(checkpoint.sums);
}

Losses LifterTraining::MeanLossesOf(const TrainingSet& set, std::size_t frames_wanted) {
  const std::size_t stride = (set.frames.size() + frames_wanted - 1) / frames_wanted;
  return MeanLosses(set, stride,
                    [&](const std::vector<const TrainingFrame*>& frames) { return objective_->OfFrames(set, frames); });
}

std::optional<double> LifterTraining::ValidationLoss() {
  if (split_.validation.frames.empty()) return std::nullopt;
  return MeanLossesOf(split_.validation, split_.validation.frames.size()).total.item<double>();
}

void LifterTraining::EndStage() {
  const double loss = MeanLossesOf(split_.training, kComparedFrames).view.item<double>();
  folder_.AddMetrics(Json{{"restart", restarts_.running}, {"seed", seed()}, {"view", loss}}.dump());
  LogInfo("restart {} of {}: loss of view consistency {:.4f}", restarts_.running + 1, options_.restarts, loss);
  restarts_.losses.push_back(loss);
  if (BestRestart(restarts_.losses) == restarts_.running) {
    restarts_.best = std::make_shared<const Checkpoint>(MakeCheckpointOfRestart());
  }
  if (IsRestarting()) {
    ++restarts_.running;
    StartAfresh();
    return;
  }
  restarts_.running = BestRestart(restarts_.losses);
  RestoreRestart(*std::exchange(restarts_.best, nullptr), folder_.checkpoint_file());
  LogInfo("continuing with restart {}, the best", restarts_.running + 1);
}

void LifterTraining::EndEpoch(const EpochSums& sums) {
  const double seconds = SecondsSince(std::exchange(epoch_start_, Clock::now()));
  // The epochs of a restart are not recorded: only those of the chosen one are part of the run, and those after it are
  // enough.
  if (IsRestarting()) return;
  const std::int64_t epoch = state_.step / steps_per_epoch();
  const EpochSums mean = sums.Mean();
  const std::optional<double> validation = ValidationLoss();
  ModelInfo info;
  objective_->Describe(info);
  Json line;
  line["epoch"] = epoch;
  line["step"] = state_.step;
  line["learning_rate"] = options_.learning_rate * LearningRateFactor(options_, schedule_, state_.step - 1);
  line["loss"] = mean.total;
  for (const LossTerm& term : objective_->Terms(mean)) line[term.name] = term.value;
  line["validation"] = validation ? Json(*validation) : Json(nullptr);
  line["perspective"] = info.perspective;
  line["seconds"] = seconds;
  folder_.AddMetrics(line.dump());
  folder_.WriteLog(fmt::format("epoch {}/{}: loss {:.4f}, validation {:.4f}", epoch, schedule_.epochs, mean.total,
                               validation.value_or(NAN)));
}

std::string LifterTraining::DescribeLoss(const EpochSums& sums) const {
  const EpochSums mean = sums.Mean();
  std::vector<std::string> terms;
  for (const LossTerm& term : objective_->Terms(mean)) terms.push_back(fmt::format("{} {:.3f}", term.name, term.value));
  const std::string total = fmt::format("loss {:.4f}", mean.total);
  return terms.empty() ? total : fmt::format("{} ({})", total, fmt::join(terms, ", "));
}

TrainReport LifterTraining::Finish() {
  objective_->Finish();
  TrainReport report;
  report.validation_loss = ValidationLoss();
  objective_->Describe(info_);
  info_.steps = state_.step;
  report.model = {info_, ParametersOf(*lifter_.network)};
  folder_.WriteModel(report.model);
  return report;
}

void LifterTraining::DescribeStart() const {
  const std::vector<std::uint8_t>& static_captures = split_.training.static_captures;
  const auto moving = std::count(static_captures.begin(), static_captures.end(), std::uint8_t{0});
  LogInfo("{} frames to train on, {} held out, {} left out ({})", split_.training.frames.size(),
          split_.validation.frames.size(), split_.frames_left_out, objective_->WhyLeftOut());
  LogInfo("preset {}, width {}, {} epochs of {} steps on {} ({} threads)", options_.preset, options_.width,
          schedule_.epochs, schedule_.steps_per_epoch, options_.device, ThreadCount());
  if (options_.epochs == 0 && schedule_.epochs != options_.default_epochs) {
    LogInfo("a small recording: {} epochs instead of {}, so that {} steps are taken (`epochs` overrides)",
            schedule_.epochs, options_.default_epochs, schedule_.steps());
  }
  if (options_.camera_consistency == CameraConsistency::kStatic && moving > 0) {
    LogInfo("{} of {} captures have moving cameras: camera consistency leaves them out", moving,
            static_captures.size());
  }
}

}  // namespace

std::optional<TrainOptions> RecordedOptions(const fs::path& run_folder) {
  const fs::path path = run_folder / "checkpoint.h5";
  if (!fs::exists(path)) return std::nullopt;
  return TrainOptions::FromJson(ReadCheckpoint(path).info.options, path.string());
}

TrainReport Train(const TrainJob& given) {
  const Clock::time_point start = Clock::now();
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
  RequireEnoughFrames(job, split);
  RunFolder folder(job.run_folder, job.resume, job.overwrite, job.run_folder_lock);
  LifterTraining training(job, std::move(split), folder);
  TrainingLoop loop(training, folder, "step", job.options.checkpoint_seconds);
  folder.RemoveOldRecords();
  folder.OpenLog();
  training.DescribeStart();
  loop.StartOrResume();
  TrainReport report;
  report.stopped = !loop.Run();
  if (!report.stopped) {
    loop.RequireSoundness();
    report = training.Finish();
  }
  report.seconds = SecondsSince(start);
  return report;
}

}  // namespace canonpose
