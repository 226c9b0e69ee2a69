// canonpose train-morph data.h5... [--exact exact.h5...] -o RUN
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/field_options.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/data/choice.h"
#include "canonpose/data/dataset.h"
#include "canonpose/train/morph_trainer.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct TrainMorphArguments {
  std::vector<fs::path> detected;
  std::vector<fs::path> exact;
  fs::path run_folder;
  MorphOptions options;
  std::string subjects;
  bool resume = false;
  bool overwrite = false;
};

MorphJob MakeJob(const TrainMorphArguments& arguments) {
  if (!arguments.exact.empty() && arguments.exact.size() != arguments.detected.size()) {
    ThrowInvalidArgument("--exact: give one file for each of the {} datasets, found {}", arguments.detected.size(),
                         arguments.exact.size());
  }
  MorphJob job;
  job.options = arguments.options;
  job.run_folder = arguments.run_folder;
  job.resume = arguments.resume;
  job.overwrite = arguments.overwrite;
  for (std::size_t i = 0; i < arguments.detected.size(); ++i) {
    const std::string file = arguments.detected[i].string();
    Dataset detected = ReadDataset(arguments.detected[i]);
    if (!arguments.subjects.empty()) KeepSubjects(detected, arguments.subjects, file);
    if (i == 0) {
      job.skeleton = detected.skeleton;
      job.source = detected.source;
    }
    if (!job.skeleton.SameJoints(detected.skeleton)) {
      ThrowBadInput({file, "/skeleton", fmt::format("the joints of {}", arguments.detected.front().string()), "others",
                     "import all data onto the same skeleton"});
    }
    job.data_files.push_back(arguments.detected[i].filename().string());
    job.data_fingerprints.push_back(fmt::format("{:016x}", detected.Fingerprint()));
    if (arguments.exact.empty()) {
      AddPairsOfTruth(detected, file, job.pairs);
      continue;
    }
    const Dataset exact = ReadDataset(arguments.exact[i]);
    AddPairsOfDatasets(detected, file, exact, arguments.exact[i].string(), job.pairs);
    job.data_fingerprints.back() += fmt::format("-{:016x}", exact.Fingerprint());
  }
  return job;
}

void RunTrainMorph(const TrainMorphArguments& arguments) {
  const MorphJob job = MakeJob(arguments);
  LogInfo("{} pairs of detected and true 2D poses", job.pairs.count());
  const StopOnSignal stop_on_signal;
  const MorphReport report = TrainMorph(job);
  if (report.stopped) {
    LogInfo("stopped and saved; to continue, run the same command with --resume");
    throw CLI::RuntimeError(StopOnSignal::exit_code());
  }
  LogInfo("joints of held-out poses are off by {:.2f} % of the pose's size, {:.2f} % before; the model is {}",
          report.after_percent, report.before_percent, (job.run_folder / "model.cpm").string());
  if (report.after_percent >= report.before_percent) {
    LogWarning(
        "the model makes held-out poses worse: do not use it. Train with more poses or more --epochs, or lift without "
        "it");
  }
}

}  // namespace

void AddTrainMorphCommand(CLI::App& app) {
  auto arguments = std::make_shared<TrainMorphArguments>();
  CLI::App* command = app.add_subcommand(
      "train-morph", "Train a network that moves a detector's 2D joints to where another skeleton has them");
  command->add_option("data", arguments->detected, "Datasets with the detector's keypoints")->required();
  command->add_option("-o,--output", arguments->run_folder, "Folder for the model, checkpoint and log")->required();
  command->add_option("--exact", arguments->exact,
                      "The same recordings with true keypoints, one file for each (default: the truth of the datasets "
                      "themselves, seen by their calibrated cameras)");
  command->add_option("--subjects", arguments->subjects, "Learn from these subjects only: A,B")->type_name("NAMES");
  AddFieldOptions(
      *command, DescribeMorphOptions(),
      {"epochs", "width", "batch_poses", "learning_rate", "validation", "seed", "threads", "device"},
      [arguments](const std::string& field, const std::string& value) { arguments->options.Set(field, value); });
  command->add_flag("--resume", arguments->resume, "Continue the run in the output folder, if there is one");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the run in the output folder");
  command->callback([arguments] { RunTrainMorph(*arguments); });
}

}  // namespace canonpose
