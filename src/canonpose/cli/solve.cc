// canonpose solve data.h5... -o solved.h5
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/duplicates.h"
#include "canonpose/data/merge.h"
#include "canonpose/data/solved_world.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/pipeline/identify_people.h"
#include "canonpose/solve/solver.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct SolveArguments {
  std::vector<fs::path> data;
  fs::path output;
  fs::path json;
  std::string frames;
  std::vector<std::string> heights;
  std::vector<std::string> camera_distances;
  std::vector<std::string> same_lens;
  std::vector<std::string> offsets;
  BootstrapOptions bootstrap;
  SolveOptions options;
};

/// All files as one recording.
Dataset ReadAll(const SolveArguments& arguments) {
  std::vector<Dataset> datasets;
  std::vector<std::string> files;
  for (const fs::path& path : arguments.data) {
    datasets.push_back(ReadDataset(path, TracksInDataset::kAllowed));
    files.push_back(path.string());
    if (!arguments.frames.empty()) KeepFrames(datasets.back(), FrameRange::Parse(arguments.frames), files.back());
  }
  if (datasets.size() > 1) RequireDistinctRecordings(datasets, files);
  return MergeDatasets(std::move(datasets), files);
}

SolveOptions Options(const SolveArguments& arguments) {
  SolveOptions options = arguments.options;
  for (const std::string& text : arguments.heights) options.measures.heights.push_back(KnownHeight::Parse(text));
  for (const std::string& text : arguments.camera_distances) {
    options.measures.distances.push_back(KnownDistance::Parse(text));
  }
  for (const std::string& text : arguments.same_lens) options.same_lens.push_back(CLI::detail::split(text, ','));
  for (const std::string& text : arguments.offsets) options.offsets.insert(ParseOffset(text));
  options.Validate();
  return options;
}

void RunSolve(const SolveArguments& arguments) {
  const SolveOptions options = Options(arguments);
  RequireDatasetName(arguments.output);
  std::vector<fs::path> inputs = arguments.data;
  inputs.push_back(arguments.bootstrap.model);
  for (const fs::path& output : {arguments.output, arguments.json}) RequireOutputIsNotAnInput(output, inputs);
  RequireSeparateOutputs(arguments.output, arguments.json, "the solved dataset and the report");
  { const AtomicFile probe(arguments.output); }  // before minutes of work
  Dataset dataset = ReadAll(arguments);
  BootstrapOptions bootstrap = arguments.bootstrap;
  bootstrap.threads = options.threads;
  std::vector<std::string> files;
  for (const fs::path& path : arguments.data) files.push_back(path.string());
  // Before minutes of work; but it is not known yet who is in a recording of several people.
  if (std::ranges::none_of(dataset.sequences, &Sequence::HasTracks)) options.RequireSizesOf(dataset);
  options.RequireCamerasOf(dataset);
  IdentifiedPeople identified = IdentifyPeople(dataset, fmt::format("{}", fmt::join(files, ", ")), bootstrap);
  SolveReport report = Solve(dataset, identified.start, options);
  report.people = std::move(identified.people);
  WriteDataset(arguments.output, dataset);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, report.ToJson());
  std::cout << report.ToText() << std::flush;
  const std::string doubt = report.Doubt();
  if (doubt.empty()) return;
  ThrowComputation("{} is written, but its 3D poses cannot be believed: {}", arguments.output.string(), doubt);
}

}  // namespace

void AddSolveCommand(CLI::App& app) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App* command =
      app.add_subcommand("solve", "Find the 3D poses and the cameras of a recording from its keypoints alone");
  command
      ->add_option("data", arguments->data,
                   "Dataset files made by import; captures of one name in several of them are solved together")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Dataset file to write: the data of all files with poses and cameras")
      ->required();
  command->add_option("--model", arguments->bootstrap.model, "Run or model file of a lifter to start from");
  command
      ->add_option(
          "--bootstrap", arguments->bootstrap.kind,
          "Without a model, start from: starter (a lifter trained on simulated people, which comes with the program), "
          "method (trained on the data itself), factorisation (no lifter: static cameras, any body), or auto: "
          "the starter where it knows the joints, otherwise factorisation or, for moving cameras, the method")
      ->check(CLI::IsMember({"auto", "starter", "method", "factorisation"}))
      ->capture_default_str();
  command
      ->add_option(
          "--mirror", arguments->options.mirror,
          "Which way round depth is. auto: decide by perspective; keep: as in the start's poses; flip: mirrored")
      ->capture_default_str();
  command
      ->add_option(
          "--height", arguments->heights,
          "Height of the person in metres, for a result in millimetres: 1.75, or NAME=1.75 for each of several "
          "people")
      ->allow_extra_args(false);
  command
      ->add_option("--camera-distance", arguments->camera_distances,
                   "Instead, a distance in metres between two static cameras: A,B=4.2")
      ->allow_extra_args(false);
  command->add_flag("--calibrated-scale", arguments->options.calibrated_scale,
                    "Instead, take the scale from the calibration that the data were imported with");
  command
      ->add_option("--distortion", arguments->options.distortion,
                   "Of the lenses of static cameras. auto: found where the keypoints show it; none: there is none")
      ->capture_default_str();
  command
      ->add_option("--same-lens", arguments->same_lens,
                   "Cameras of one model, which share their distortion: A,B,C (again for another model), or all")
      ->allow_extra_args(false);
  command
      ->add_option("--offset", arguments->offsets,
                   "How much later than the others a camera began, in seconds: cam3=1.25. Of cameras that were not "
                   "synchronised it is found otherwise")
      ->type_name("NAME=SECONDS")
      ->allow_extra_args(false);
  command->add_option("--frames", arguments->frames, "Solve frames A-B of each sequence only, counted from 0");
  command->add_option("--json", arguments->json, "Also write the report to this file, as JSON");
  command->add_option("--device", arguments->bootstrap.device, "cpu or cuda")->capture_default_str();
  command->add_option("--threads", arguments->options.threads, "Number of threads (default: all cores)");
  command->add_option("--seed", arguments->bootstrap.seed, "Seed of the lifter that --bootstrap method trains")
      ->capture_default_str();
  command->callback([arguments] { RunSolve(*arguments); });
}

}  // namespace canonpose
