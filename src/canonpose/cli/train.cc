// canonpose train data.h5... -o RUN
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/data/choice.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/pipeline/solve_then_train.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// What was given on the command line; what was not keeps the preset's value.
struct TrainArguments {
  std::vector<fs::path> data;
  fs::path run_folder;
  std::string frames;
  std::string cameras;
  std::string subjects;
  fs::path morph;
  bool resume = false;
  bool overwrite = false;
  /// Options by field name, in the order in which they apply.
  std::string preset;
  std::vector<std::pair<std::string, std::string>> named;
  std::vector<std::string> settings;
};

void Apply(const TrainArguments& arguments, TrainOptions& options) {
  for (const auto& [name, value] : arguments.named) options.Set(name, value);
  for (const std::string& setting : arguments.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) ThrowInvalidArgument("--set: expected key=value, found \"{}\"", setting);
    options.Set(setting.substr(0, equals), setting.substr(equals + 1));
  }
}

/// A resumed run keeps the options it was started with; what is given again must agree with them.
TrainOptions ResolveOptions(const TrainArguments& arguments) {
  std::optional<TrainOptions> recorded;
  if (arguments.resume) recorded = RecordedOptions(arguments.run_folder);
  TrainOptions options = PresetOptions(arguments.preset.empty() ? "best" : arguments.preset);
  if (recorded) {
    options = *recorded;
    if (!arguments.preset.empty()) options.preset = arguments.preset;
  }
  Apply(arguments, options);
  if (recorded) {
    for (const std::string& name : options.Differences(*recorded)) {
      ThrowInvalidArgument(
          "{} was started with {} = {}, not {}: leave the option out to go on with it, or train into another folder",
          arguments.run_folder.string(), name, recorded->Get(name), options.Get(name));
    }
  }
  options.Validate();
  return options;
}

/// The frames that validation holds out of one copy would be trained on in the other.
void RequireDifferentFiles(const std::vector<fs::path>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code error;
      if (fs::equivalent(files[i], files[j], error)) ThrowInvalidArgument("{} is given twice", files[i].string());
    }
  }
}

void RunTrain(const TrainArguments& arguments) {
  RequireDifferentFiles(arguments.data);
  TrainJob job;
  job.options = ResolveOptions(arguments);
  job.run_folder = arguments.run_folder;
  job.resume = arguments.resume;
  job.overwrite = arguments.overwrite;
  std::optional<PoseMorph> morph;
  if (!arguments.morph.empty()) {
    morph = PoseMorph::Open(arguments.morph, job.options.device);
    job.morph = morph->model();
  }
  for (const fs::path& path : arguments.data) {
    job.datasets.push_back(ReadDataset(path));
    job.data_files.push_back(path.filename().string());
    if (!arguments.subjects.empty()) KeepSubjects(job.datasets.back(), arguments.subjects, path.string());
    if (!arguments.cameras.empty()) KeepCameras(job.datasets.back(), arguments.cameras, path.string());
    if (morph) morph->Apply(job.datasets.back(), path.string());
    if (!arguments.frames.empty()) KeepFrames(job.datasets.back(), FrameRange::Parse(arguments.frames), path.string());
  }

  const StopOnSignal stop;
  const TrainReport report = job.options.preset == "best" ? SolveThenTrain(job) : Train(job);
  if (report.stopped) {
    LogInfo("stopped and saved; to go on, run the same command with --resume");
    throw CLI::RuntimeError(stop.exit_code());
  }
  const std::string perspective =
      job.options.perspective == "learned" ? fmt::format(", perspective factor {:.2f}", report.model.perspective) : "";
  LogInfo("trained {} steps in {}{}{}; the model is {}", report.model.steps, FormatDuration(report.seconds),
          report.validation_loss ? fmt::format(", validation loss {:.4f}", *report.validation_loss) : "", perspective,
          (job.run_folder / "model.cpm").string());
}

}  // namespace

void AddTrainCommand(CLI::App& app) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = app.add_subcommand("train", "Train a lifter on datasets, without labels or calibration");
  command->add_option("data", arguments->data, "Dataset files made by import")->required();
  command->add_option("-o,--output", arguments->run_folder, "Folder for the model, checkpoints and logs")->required();
  command->add_option("--preset", arguments->preset, fmt::format("One of {} (default best)", PresetNames()));
  // These are --set with a name of their own.
  const auto add = [&](const std::string& option, const std::string& field, const std::string& help) {
    command
        ->add_option_function<std::string>(
            option, [arguments, field](const std::string& value) { arguments->named.emplace_back(field, value); }, help)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  };
  add("--epochs", "epochs", "Times to go through the data (default 100, more for small recordings)");
  add("--width", "width", "Width of the network's layers (default 256 for best and plus, otherwise 1024)");
  add("--device", "device", "cpu or cuda (default cpu)");
  add("--seed", "seed", "Seed of all randomness (default 0)");
  add("--mirror", "mirror", "auto: decide by perspective; keep or flip: by your choice (default auto)");
  add("--threads", "threads",
      "Number of threads (default: 1 to train, all cores to solve). More than 1 helps wide networks on an idle "
      "machine");
  command->add_option("--frames", arguments->frames, "Train on frames A-B of each sequence only, counted from 0");
  command->add_option("--subjects", arguments->subjects, "Train on these subjects only: A,B");
  command->add_option("--cameras", arguments->cameras,
                      "Train on these cameras only: A,B, or the first N of each sequence");
  command->add_option("--morph", arguments->morph,
                      "Move the detector's joints by this morphing network first (train-morph); the model keeps it");
  command->add_flag("--resume", arguments->resume, "Go on with the run in the output folder where there is one");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the run in the output folder");
  command->add_option("--set", arguments->settings, "key=value for any training option; an unknown key lists them")
      ->allow_extra_args(false);
  command->callback([arguments] { RunTrain(*arguments); });
}

}  // namespace canonpose
