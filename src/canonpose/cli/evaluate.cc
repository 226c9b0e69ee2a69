// canonpose evaluate RUN|model.cpm data.h5...
// canonpose evaluate --predictions pred.npz --truth truth.npz
// canonpose evaluate solved.h5
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/archives.h"
#include "canonpose/evaluate/reference.h"
#include "canonpose/evaluate/report.h"
#include "canonpose/lift/lifter.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<fs::path> paths;  ///< a model and datasets, or solved datasets
  fs::path predictions;
  fs::path truth;
  fs::path json;
  std::string protocol = kAllFrames;
  std::string frames;
  std::vector<std::string> left_out;
  std::optional<int> root;
  std::string device = "cpu";
  long seed = 0;
};

/// The poses (T, J, 3) predicted for a view, in its camera's frame; empty where there are none.
using Predictor = std::function<std::vector<float>(const CameraView& view, int frame_count)>;

FrameRange Frames(const Arguments& arguments) {
  return arguments.frames.empty() ? FrameRange{} : FrameRange::Parse(arguments.frames);
}

Dataset ReadFrames(const Arguments& arguments, const fs::path& path) {
  Dataset dataset = ReadDataset(path);
  if (!arguments.frames.empty()) KeepFrames(dataset, Frames(arguments), path.string());
  return dataset;
}

/// Adds all views of a dataset that have reference poses. `prefix` stands before the names of its sequences.
void EvaluateDataset(const Dataset& dataset, const ReferencePoses& reference, const std::string& prefix,
                     const Predictor& predict, Evaluation& evaluation) {
  long view_count = 0;
  for (const Sequence& sequence : dataset.sequences) view_count += static_cast<long>(sequence.cameras.size());
  Progress progress("evaluate", view_count);
  long done = 0;
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    const Sequence& sequence = dataset.sequences[s];
    for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
      progress.Update(done++, sequence.name + " " + sequence.cameras[c].name);
      const std::vector<float>& truth = reference.sequences()[s].poses_in_camera[c];
      if (truth.empty()) continue;
      std::vector<float> predicted = predict(sequence.cameras[c], sequence.frame_count);
      if (predicted.empty()) predicted.assign(truth.size(), std::numeric_limits<float>::quiet_NaN());
      evaluation.AddAll(prefix + sequence.name, predicted, truth);
    }
  }
}

/// Evaluates datasets of the same joints one after the other. `check` throws where one does not suit; `with_cameras`:
/// solved cameras are compared, too.
EvaluationReport EvaluateDatasets(const Arguments& arguments, const std::vector<fs::path>& files,
                                  const std::function<void(const Dataset&, const fs::path&)>& check,
                                  const Predictor& predict, bool with_cameras) {
  std::optional<Evaluation> evaluation;
  Skeleton skeleton;
  ReferenceSummary summary;
  CameraComparison cameras;
  for (const fs::path& file : files) {
    const Dataset dataset = ReadFrames(arguments, file);
    check(dataset, file);
    if (!evaluation) {
      skeleton = dataset.skeleton;
      evaluation.emplace(skeleton.joints, skeleton.root, arguments.left_out);
    }
    if (!skeleton.SameJoints(dataset.skeleton)) {
      ThrowBadInput({file.string(), "/skeleton", "the joints of " + files.front().string(), "others",
                     "evaluate files with different joints one by one"});
    }
    const ReferencePoses reference(dataset, file.string());
    summary.Add(reference);
    if (with_cameras) cameras.Add(dataset);
    EvaluateDataset(dataset, reference, files.size() > 1 ? file.stem().string() + "/" : "", predict, *evaluation);
  }
  EvaluationReport report = evaluation->Finish(summary.Kind(), files.front().string());
  report.cameras = cameras.Medians();
  return report;
}

EvaluationReport EvaluateModel(const Arguments& arguments) {
  const PoseLifter lifter = PoseLifter::Open(arguments.paths.front(), arguments.device);
  return EvaluateDatasets(
      arguments, {arguments.paths.begin() + 1, arguments.paths.end()},
      [&](const Dataset& dataset, const fs::path& file) { lifter.RequireSkeleton(dataset.skeleton, file.string()); },
      [&](const CameraView& view, int frame_count) { return lifter.Lift(view, frame_count).pose_in_camera; },
      /*with_cameras=*/false);
}

EvaluationReport EvaluateSolved(const Arguments& arguments) {
  return EvaluateDatasets(
      arguments, arguments.paths,
      [](const Dataset& dataset, const fs::path& file) {
        if (dataset.HasSolved()) return;
        ThrowBadInput(
            {file.string(), "", "solved poses, since no model was given", "none", "name a model before the data"});
      },
      [](const CameraView& view, int) { return view.solved; }, /*with_cameras=*/true);
}

EvaluationReport Evaluate(const Arguments& arguments) {
  if (arguments.protocol != kAllFrames) {
    ThrowUsage("--protocol {}: the only protocol is {}", arguments.protocol, kAllFrames);
  }
  const bool archives = !arguments.predictions.empty() || !arguments.truth.empty();
  if (archives) {
    if (arguments.predictions.empty() || arguments.truth.empty()) ThrowUsage("--predictions and --truth go together");
    if (!arguments.paths.empty()) ThrowUsage("give either --predictions and --truth, or a model and data");
    return EvaluateArchives(arguments.predictions, arguments.truth,
                            {arguments.root, arguments.left_out, Frames(arguments)});
  }
  if (arguments.paths.empty()) {
    ThrowUsage("give a model and datasets, or a solved dataset, or --predictions and --truth");
  }
  if (arguments.root) ThrowUsage("--root is for --predictions; a dataset names its root itself");
  const fs::path& first = arguments.paths.front();
  if (!fs::exists(first)) {
    ThrowBadInput({first.string(), "", "a model, a run or a solved dataset", "nothing", "check the path"});
  }
  if (IsDatasetFile(first)) return EvaluateSolved(arguments);
  if (arguments.paths.size() < 2) ThrowUsage("give the data to evaluate {} on", first.string());
  return EvaluateModel(arguments);
}

void RunEvaluate(const Arguments& arguments) {
  const EvaluationReport report = Evaluate(arguments);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, ReportAsJson(report));
  std::cout << ReportAsTable(report) << std::flush;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure a model, predictions or solved poses against truth, or against a calibrated triangulation");
  command->add_option("paths", arguments->paths, "A run or model file and then datasets; or solved datasets alone");
  command->add_option("--predictions", arguments->predictions, "Archive (.npz) with pose3d (N, J, 3) in any unit");
  command->add_option("--truth", arguments->truth, "Archive (.npz) with pose3d (N, J, 3) in mm");
  command->add_option("--json", arguments->json, "Write the figures to this file, too");
  command->add_option("--protocol", arguments->protocol, "Which poses are compared and how: all-frames")
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "Evaluate frames A-B of each sequence only, counted from 0");
  command->add_option("--exclude-joints", arguments->left_out, "Leave these joints out: A,B")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--root", arguments->root,
                      "Root joint of --predictions by number (default: by the archive's joint names, otherwise 0)");
  command->add_option("--device", arguments->device, "cpu or cuda")->capture_default_str();
  command->add_option("--seed", arguments->seed, "Taken like by every command; evaluation has nothing random");
  command->callback([arguments] { RunEvaluate(*arguments); });
}

}  // namespace canonpose
