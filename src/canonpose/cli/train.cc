// canonpose train data.h5... -o RUN
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/field_options.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/data/choice.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/pipeline/solve_then_train.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefaultPreset = "best";

/// What was given on the command line. Options that were not given keep the preset's values.
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
    if (equals == std::string::npos) ThrowInvalidArgument("--set: expected NAME=VALUE, found \"{}\"", setting);
    options.Set(setting.substr(0, equals), setting.substr(equals + 1));
  }
}

/// A resumed run keeps the options it was started with; what is given again must agree with them.
TrainOptions ResolveOptions(const TrainArguments& arguments) {
  std::optional<TrainOptions> recorded;
  if (arguments.resume) recorded = RecordedOptions(arguments.run_folder);
  TrainOptions options = PresetOptions(arguments.preset.empty() ? kDefaultPreset : arguments.preset);
  if (recorded) {
    options = *recorded;
    if (!arguments.preset.empty()) options.preset = arguments.preset;
  }
  Apply(arguments, options);
  if (recorded) {
    for (const std::string& name : options.Differences(*recorded)) {
      ThrowInvalidArgument(
          "{} was started with {} = {}, not {}: leave the option out to continue it, or train into another folder",
          arguments.run_folder.string(), name, recorded->Get(name), options.Get(name));
    }
  }
  options.Validate();
  return options;
}

/// Otherwise frames that are held out for validation in one copy would be trained on in the other.
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
  std::vector<fs::path> inputs = arguments.data;
  inputs.insert(inputs.end(), {arguments.morph, arguments.morph / "model.cpm"});
  RequireOutputIsNotAnInput(arguments.run_folder / "model.cpm", inputs);
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

  const StopOnSignal stop_on_signal;
  const TrainReport report = job.options.supervision == Supervision::kSolved ? SolveThenTrain(job) : Train(job);
  if (report.stopped) {
    LogInfo("stopped and saved; to continue, run the same command with --resume");
    throw CLI::RuntimeError(StopOnSignal::exit_code());
  }
  const std::string perspective = job.options.perspective == PerspectiveForm::kLearned
                                      ? fmt::format(", perspective factor {:.2f}", report.model.info.perspective)
                                      : "";
  LogInfo("trained {} steps in {}{}{}; the model is {}", report.model.info.steps, FormatDuration(report.seconds),
          report.validation_loss ? fmt::format(", validation loss {:.4f}", *report.validation_loss) : "", perspective,
          (job.run_folder / "model.cpm").string());
  const std::vector<std::string> doubts = DoubtsAbout(report.model.info);
  if (doubts.empty()) return;
  ThrowComputation("{} is written, but its 3D poses cannot be believed: {}; the warnings above say what to do",
                   (job.run_folder / "model.cpm").string(), fmt::join(doubts, ", and "));
}

std::string TrainFooter() {
  std::vector<std::pair<std::string, std::string>> presets;
  for (const Preset& preset : Presets()) presets.emplace_back(preset.name, preset.description);
  std::vector<OptionDescription> options = DescribeTrainOptions();
  std::erase_if(options, [](const OptionDescription& option) { return option.name == "preset"; });
  return "Presets:\n" + ListInColumns(presets) + "\nTraining options, for --set NAME=VALUE:\n" + ListOptions(options);
}

}  // namespace

void AddTrainCommand(CLI::App& app) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command = app.add_subcommand("train", "Train a lifter on datasets, without labels or calibration");
  command->add_option("data", arguments->data, "Dataset files made by import")->required();
  command->add_option("-o,--output", arguments->run_folder, "Folder for the model, checkpoints and logs")->required();
  command->add_option("--preset", arguments->preset,
                      fmt::format("One of {}; see below (default {})", PresetNames(), kDefaultPreset));
  // These are --set with a name of their own.
  AddFieldOptions(
      *command, DescribeTrainOptions(), {"epochs", "width", "device", "seed", "mirror", "threads"},
      [arguments](const std::string& field, const std::string& value) { arguments->named.emplace_back(field, value); });
  command->add_option("--frames", arguments->frames, "Train on frames A-B of each sequence only, counted from 0");
  command->add_option("--subjects", arguments->subjects, "Train on these subjects only: A,B");
  command->add_option("--cameras", arguments->cameras,
                      "Train on these cameras only: A,B, or the first N of each sequence");
  command->add_option("--morph", arguments->morph,
                      "Move the detector's joints with this morphing network first (train-morph); the model keeps it");
  command->add_flag("--resume", arguments->resume, "Continue the run in the output folder, if there is one");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the run in the output folder");
  command->add_option("--set", arguments->settings, "NAME=VALUE for any training option; they are listed below")
      ->allow_extra_args(false);
  command->footer(TrainFooter());
  command->callback([arguments] { RunTrain(*arguments); });
}

}  // namespace canonpose
