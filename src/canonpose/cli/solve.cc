// canonpose solve data.h5 -o solved.h5
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/lift/lifter.h"
#include "canonpose/solve/solver.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path data;
  fs::path output;
  fs::path model;
  SolveOptions options;
  long seed = 0;
};

void RunSolve(const Arguments& arguments) {
  Dataset dataset = ReadDataset(arguments.data);
  const PoseLifter lifter = PoseLifter::Open(arguments.model);
  lifter.RequireSkeleton(dataset.skeleton, arguments.data.string());
  StartPoses start;
  for (const Sequence& sequence : dataset.sequences) {
    start.sequences.emplace_back();
    for (const CameraView& view : sequence.cameras) {
      start.sequences.back().push_back(lifter.Lift(view, sequence.frame_count).pose_in_camera);
    }
  }
  const SolveReport report = Solve(dataset, start, arguments.options);
  WriteDataset(arguments.output, dataset);
  std::cout << report.ToText() << std::flush;
}

}  // namespace

void AddSolveCommand(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("solve", "Find 3D poses and cameras of a recording from its keypoints alone");
  command->add_option("data", arguments->data, "Dataset made by import")->required();
  command->add_option("-o,--output", arguments->output, "Dataset to write, with `solved`")->required();
  command->add_option("--model", arguments->model, "Trained lifter to start from")->required();
  command->add_option("--threads", arguments->options.threads, "Number of threads (default: all)");
  command->add_option("--seed", arguments->seed, "");
  command->callback([arguments] { RunSolve(*arguments); });
}

}  // namespace canonpose
