// canonpose info FILE: what any of our files is, holds and came from.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/npz.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/checkpoint.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

void PrintSkeleton(const Skeleton& skeleton, const DatasetSource& source) {
  fmt::print("skeleton     {}{} joints, root {}\n", skeleton.name.empty() ? "" : skeleton.name + ", ",
             skeleton.joint_count(), skeleton.joints[static_cast<std::size_t>(skeleton.root)]);
  fmt::print("joints       {}\n", fmt::join(skeleton.joints, ", "));
  if (source.format.empty()) return;
  fmt::print(
      "made from    {}{}{}\n", source.format, source.layout.empty() ? "" : fmt::format(", layout {}", source.layout),
      source.confidence_scale == 1.0 ? "" : fmt::format(", confidences divided by {:g}", source.confidence_scale));
  for (const std::string& line : source.mapping) {
    if (line.find('(') != std::string::npos) fmt::print("derived      {}\n", line);
  }
}

/// Share of joints seen, in percent.
double SeenPercent(const CameraView& view) {
  if (view.confidence.empty()) return 0.0;
  const auto seen = std::count_if(view.confidence.begin(), view.confidence.end(), [](float c) { return c > 0.0F; });
  return 100.0 * static_cast<double>(seen) / static_cast<double>(view.confidence.size());
}

void PrintDataset(const Dataset& dataset) {
  std::size_t frames = 0;
  for (const Sequence& sequence : dataset.sequences) frames += static_cast<std::size_t>(sequence.frame_count);
  fmt::print("dataset      {} sequences, {} frames, fingerprint {:016x}\n", dataset.sequences.size(), frames,
             dataset.Fingerprint());
  PrintSkeleton(dataset.skeleton, dataset.source);
  for (const Sequence& sequence : dataset.sequences) {
    fmt::print("sequence     {}: subject {}, {} frames{}, {} cameras, capture {}\n", sequence.name, sequence.subject,
               sequence.frame_count, sequence.fps > 0 ? fmt::format(" at {:g}/s", sequence.fps) : "",
               sequence.static_cameras ? "static" : "moving", sequence.capture);
    if (!sequence.actions.empty()) fmt::print("  actions    {}\n", fmt::join(sequence.actions, ", "));
    if (!sequence.truth_kind.empty()) fmt::print("  truth      {}\n", sequence.truth_kind);
    for (const CameraView& view : sequence.cameras) {
      fmt::print("  camera     {}: {}x{} px, {:.1f} % of joints seen{}{}{}\n", view.name, view.image_size[0],
                 view.image_size[1], SeenPercent(view), view.truth.empty() ? "" : ", truth",
                 view.solved.empty() ? "" : ", solved", view.calibration.empty() ? "" : ", calibrated");
    }
  }
}

void PrintModel(const ModelInfo& info) {
  fmt::print("made by      canonpose {}\n", info.program_version);
  fmt::print("training     preset {}, network {}, width {}, seed {}, {} steps\n", info.preset, info.network, info.width,
             info.seed, info.steps);
  fmt::print("mirror       {}", info.mirror.decision);
  if (info.mirror.slope_error > 0.0) {
    fmt::print(" (slope {:+.3f} +- {:.3f} before the decision; negative is right)", info.mirror.slope,
               info.mirror.slope_error);
  }
  fmt::print("\n");
  if (!info.trap.verdict.empty()) {
    fmt::print("trap         {} (depth {:.2f} of width, views {:.0f} degrees apart, scattered by {:.0f})\n",
               info.trap.verdict, info.trap.depth_ratio, info.trap.angle_deg, info.trap.scatter_deg);
  }
  if (info.morph) fmt::print("morph        2D poses go through a network of width {} first\n", info.morph->info.width);
  if (info.perspective != 0.0) fmt::print("perspective  {:.3f}\n", info.perspective);
  for (std::size_t i = 0; i < info.data_files.size(); ++i) {
    fmt::print("data         {} (fingerprint {})\n", info.data_files[i], info.data_fingerprints[i]);
  }
  PrintSkeleton(info.skeleton, info.source);
  fmt::print("options      {}\n", info.options);
}

void PrintNpz(const fs::path& path) {
  const NpzReader file(path);
  for (const std::string& name : file.names()) {
    const NpyArray array = file.Read(name);
    const bool is_single_text = array.is_text() && array.shape.empty();
    fmt::print(
        "array        {}: {}\n", name,
        is_single_text ? std::get<std::vector<std::string>>(array.values).front() : h5::FormatShape(array.shape));
  }
}

void RunInfo(const fs::path& path) {
  fmt::print("file         {}\n", path.string());
  if (!fs::exists(path)) ThrowBadInput({path.string(), "", "a file", "nothing", "check the path"});
  if (IsModel(path)) {
    fmt::print("kind         model\n");
    return PrintModel(ReadModelInfo(path));
  }
  const fs::path checkpoint = fs::is_directory(path) ? path / "checkpoint.h5" : path;
  if (IsCheckpoint(checkpoint)) {
    fmt::print("kind         checkpoint of an unfinished or finished training run\n");
    return PrintModel(ReadCheckpoint(checkpoint).info);
  }
  if (path.extension() == ".npz") {
    fmt::print("kind         NumPy arrays\n");
    return PrintNpz(path);
  }
  fmt::print("kind         dataset\n");
  PrintDataset(ReadDataset(path));
}

}  // namespace

void AddInfoCommand(CLI::App& app) {
  auto path = std::make_shared<fs::path>();
  auto seed = std::make_shared<long>(0);
  CLI::App* command = app.add_subcommand("info", "Tell what a file of ours is, holds and came from");
  command->add_option("file", *path, "A dataset, model, run folder, checkpoint or .npz file")->required();
  command->add_option("--seed", *seed, "Taken like by every command; nothing here is random");
  command->callback([path, seed] { RunInfo(*path); });
}

}  // namespace canonpose
