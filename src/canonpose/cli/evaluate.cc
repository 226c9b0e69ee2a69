// canonpose evaluate RUN|model.cpm data.h5...
// canonpose evaluate --predictions pred.npz --truth truth.npz
// canonpose evaluate solved.h5
// canonpose evaluate --triangulate data.h5
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/option_names.h"
#include "canonpose/cli/with_torch.h"
#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/archives.h"
#include "canonpose/evaluate/report.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  std::vector<fs::path> paths;  ///< a model and datasets, or solved datasets
  fs::path predictions;
  fs::path truth;
  fs::path json;
  fs::path frame_errors;
  std::string protocol = kAllFrames;
  std::string frames;
  std::vector<std::string> left_out;
  std::optional<int> root;
  bool triangulate = false;
  bool canonical = false;
  bool list_protocols = false;
  std::string device = "cpu";
};

DatasetEvaluation Job(const EvaluateArguments& arguments, FrameErrors* frame_errors) {
  DatasetEvaluation job;
  job.files = arguments.paths;
  job.protocol = FindProtocol(arguments.protocol);
  if (!arguments.frames.empty()) job.frames = FrameRange::Parse(arguments.frames);
  job.left_out = arguments.left_out;
  job.canonical = arguments.canonical;
  job.frame_errors = frame_errors;
  return job;
}

EvaluationReport EvaluateArchivePair(const EvaluateArguments& arguments, FrameErrors* frame_errors) {
  if (arguments.predictions.empty() || arguments.truth.empty())
    ThrowInvalidArgument("--predictions and --truth go together");
  if (!arguments.paths.empty()) ThrowInvalidArgument("give either --predictions and --truth, or a model and data");
  if (arguments.triangulate) ThrowInvalidArgument("--triangulate is for datasets");
  if (arguments.canonical) ThrowInvalidArgument("--canonical is for a model: poses alone have no canonical form");
  const Protocol& protocol = FindProtocol(arguments.protocol);
  if (protocol.name != kAllFrames) {
    ThrowInvalidArgument(
        "--protocol {}: archives of poses name neither subjects nor sequences, so that only {} makes sense",
        protocol.name, kAllFrames);
  }
  const FrameRange frames = arguments.frames.empty() ? FrameRange{} : FrameRange::Parse(arguments.frames);
  return EvaluateArchives(arguments.predictions, arguments.truth,
                          {arguments.root, arguments.left_out, frames, frame_errors});
}

EvaluationReport EvaluatePaths(const EvaluateArguments& arguments, FrameErrors* frame_errors) {
  if (arguments.paths.empty()) {
    ThrowInvalidArgument("give a model and datasets, or a solved dataset, or --predictions and --truth");
  }
  if (arguments.root) ThrowInvalidArgument("--root is for --predictions; a dataset names its root itself");
  DatasetEvaluation job = Job(arguments, frame_errors);
  const fs::path& first = arguments.paths.front();
  if (!fs::exists(first)) {
    ThrowBadInput({first.string(), "", "a model, a run or a solved dataset", "nothing", "check the path"});
  }
  const bool is_data = IsDatasetFile(first);
  if (arguments.canonical && (is_data || arguments.triangulate)) {
    ThrowInvalidArgument("--canonical is for a model: name one before the data, without --triangulate");
  }
  if (arguments.triangulate) {
    if (!is_data) ThrowInvalidArgument("--triangulate takes only datasets, and {} is not one", first.string());
    return EvaluateDatasets(job, TriangulatedPoses());
  }
  if (is_data) {
    job.with_cameras = true;
    return EvaluateDatasets(job, SolvedPoses());
  }
  if (arguments.paths.size() < 2) ThrowInvalidArgument("give the data to evaluate {} on", first.string());
  job.files.erase(job.files.begin());
  return EvaluateModel(first, arguments.device, job);
}

void RunEvaluate(const EvaluateArguments& arguments, const CLI::App& app) {
  if (arguments.list_protocols) {
    if (!arguments.json.empty()) WriteFileAtomically(arguments.json, ProtocolListAsJson());
    std::cout << ProtocolList() << std::flush;
    return;
  }
  if (!arguments.frame_errors.empty()) FrameErrors::RequireFormat(arguments.frame_errors);
  std::vector<fs::path> inputs = arguments.paths;
  inputs.insert(inputs.end(), {arguments.predictions, arguments.truth});
  for (const fs::path& output : {arguments.json, arguments.frame_errors}) RequireOutputIsNotAnInput(output, inputs);
  RequireSeparateOutputs(arguments.json, arguments.frame_errors, "the figures and the errors of single poses");
  FrameErrors frame_errors;
  FrameErrors* wanted = arguments.frame_errors.empty() ? nullptr : &frame_errors;
  const bool archives = !arguments.predictions.empty() || !arguments.truth.empty();
  const EvaluationReport report = archives ? EvaluateArchivePair(arguments, wanted) : EvaluatePaths(arguments, wanted);
  for (const std::string& warning : report.warnings) LogWarning("{}", warning);
  if (wanted != nullptr) frame_errors.Write(arguments.frame_errors, report.all_joints);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, ReportAsJson(report));
  std::cout << SpellOptions(ReportAsTable(report), app, IsTrainingOption) << std::flush;
}

std::string ProtocolHelp() {
  std::vector<std::string> names;
  for (const Protocol& protocol : Protocols()) names.push_back(protocol.name);
  return fmt::format("Which poses are compared and how: {} (see --list-protocols)", fmt::join(names, ", "));
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure a model, predictions or solved poses against truth, or against a calibrated triangulation");
  command->add_option("paths", arguments->paths, "A run or model file and then datasets; or solved datasets alone");
  command->add_option("--predictions", arguments->predictions, "Archive (.npz) with pose3d (N, J, 3) in any unit");
  command->add_option("--truth", arguments->truth, "Archive (.npz) with pose3d (N, J, 3) in mm");
  command->add_option("--json", arguments->json, "Also write the figures, or the protocols, to this file");
  command->add_option("--protocol", arguments->protocol, ProtocolHelp())->capture_default_str();
  command->add_flag("--list-protocols", arguments->list_protocols, "Print all protocols in words");
  command->add_flag("--triangulate", arguments->triangulate,
                    "Evaluate the triangulation from all calibrated cameras of datasets with truth");
  command->add_flag(
      "--canonical", arguments->canonical,
      "Also report how much a model's canonical poses differ between the views of a frame, and between frames");
  command->add_option(
      "--frame-errors", arguments->frame_errors,
      "Write the errors of every single pose to this file: .csv, or .npz, which also has those of each joint");
  command->add_option("--frames", arguments->frames, "Evaluate frames A-B of each sequence only, counted from 0");
  command->add_option("--exclude-joints", arguments->left_out, "Leave these joints out: A,B")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--root", arguments->root,
                      "Root joint of --predictions by number (default: by the archive's joint names, otherwise 0)");
  command->add_option("--device", arguments->device, "cpu or cuda")->capture_default_str();
  command->callback([arguments, &app] { RunEvaluate(*arguments, app); });
}

}  // namespace canonpose
