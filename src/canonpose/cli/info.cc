// canonpose info FILE: what a file of ours is, what it holds and where it came from.
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/info_facts.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

struct InfoArguments {
  fs::path path;
  bool json = false;
};

std::string TextIn(const Facts& facts, const char* key) { return facts.at(key).get<std::string>(); }
double NumberIn(const Facts& facts, const char* key) { return facts.at(key).get<double>(); }
long CountIn(const Facts& facts, const char* key) { return facts.at(key).get<long>(); }
bool IsIn(const Facts& facts, const char* key) { return facts.at(key).get<bool>(); }
bool IsKnown(const Facts& facts, const char* key) { return !facts.at(key).is_null(); }

void PrintSkeleton(const Facts& skeleton) {
  const auto joints = skeleton.at("joints").get<Texts>();
  fmt::print("skeleton     {}{} joints, root {}\n", IsKnown(skeleton, "name") ? TextIn(skeleton, "name") + ", " : "",
             joints.size(), joints.at(skeleton.at("root").get<std::size_t>()));
  fmt::print("joints       {}\n", fmt::join(joints, ", "));
}

void PrintSource(const Facts& source) {
  if (source.is_null()) return;
  const double scale = NumberIn(source, "confidence_scale");
  fmt::print("made from    {}{}{}\n", TextIn(source, "format"),
             IsKnown(source, "layout") ? fmt::format(", layout {}", TextIn(source, "layout")) : "",
             scale == 1.0 ? "" : fmt::format(", confidences divided by {:g}", scale));
  if (IsKnown(source, "morph")) fmt::print("morphed by   {}\n", TextIn(source, "morph"));
  for (const std::string& line : source.at("mapping").get<Texts>()) {
    if (line.find('(') != std::string::npos) fmt::print("derived      {}\n", line);
  }
}

void PrintCamera(const Facts& camera) {
  const Facts& size = camera.at("image_size");
  const std::size_t tracks = camera.at("tracks").get<std::size_t>();
  fmt::print("  camera     {}: {}x{} px, {}{}{}{}\n", TextIn(camera, "name"), size.at(0).get<int>(),
             size.at(1).get<int>(),
             tracks > 0 ? fmt::format("{} tracks of people", tracks)
                        : fmt::format("{:.1f} % of joints seen", NumberIn(camera, "seen_percent")),
             IsIn(camera, "truth") ? ", truth" : "", IsIn(camera, "solved") ? ", solved" : "",
             IsIn(camera, "calibrated") ? ", calibrated" : "");
}

void PrintSequence(const Facts& sequence) {
  fmt::print("sequence     {}: subject {}, {} frames{}, {} cameras, capture {}\n", TextIn(sequence, "name"),
             TextIn(sequence, "subject"), CountIn(sequence, "frames"),
             IsKnown(sequence, "fps") ? fmt::format(" at {:g}/s", NumberIn(sequence, "fps")) : "",
             IsIn(sequence, "static_cameras") ? "static" : "moving", TextIn(sequence, "capture"));
  const auto actions = sequence.at("actions").get<Texts>();
  if (!actions.empty()) fmt::print("  actions    {}\n", fmt::join(actions, ", "));
  if (IsKnown(sequence, "truth_kind")) fmt::print("  truth      {}\n", TextIn(sequence, "truth_kind"));
  if (IsKnown(sequence, "scene")) fmt::print("  together   with the others of {}\n", TextIn(sequence, "scene"));
  if (IsKnown(sequence, "solved")) {
    const Facts& solved = sequence.at("solved");
    fmt::print("  solved     in {}\n", TextIn(solved, "unit"));
    for (const char* what : {"up", "floor", "scale"}) {
      if (IsKnown(solved, what)) fmt::print("  {:<10} from {}\n", what, TextIn(solved, what));
    }
  }
  for (const Facts& camera : sequence.at("cameras")) PrintCamera(camera);
}

void PrintDataset(const Facts& facts) {
  fmt::print("kind         dataset\n");
  fmt::print("dataset      {} sequences, {} frames, fingerprint {}\n", facts.at("sequences").size(),
             CountIn(facts, "frames"), TextIn(facts, "fingerprint"));
  PrintSkeleton(facts.at("skeleton"));
  PrintSource(facts.at("source"));
  for (const Facts& sequence : facts.at("sequences")) PrintSequence(sequence);
}

void PrintMirror(const Facts& mirror) {
  fmt::print("mirror       {}", TextIn(mirror, "decision"));
  if (IsKnown(mirror, "slope")) {
    fmt::print(" (slope {:+.3f} +- {:.3f} before the decision; negative is right)", NumberIn(mirror, "slope"),
               NumberIn(mirror, "slope_error"));
  }
  fmt::print("\n");
}

void PrintModel(const Facts& facts) {
  fmt::print("kind         {}\n",
             TextIn(facts, "kind") == "model" ? "model" : "checkpoint of an unfinished or finished training run");
  fmt::print("made by      canonpose {}\n", TextIn(facts, "program_version"));
  fmt::print("training     preset {}, network {}, width {}, seed {}, {} steps\n", TextIn(facts, "preset"),
             TextIn(facts, "network"), CountIn(facts, "width"), facts.at("seed").get<std::uint64_t>(),
             CountIn(facts, "steps"));
  PrintMirror(facts.at("mirror"));
  if (IsKnown(facts, "trap")) {
    const Facts& trap = facts.at("trap");
    fmt::print(
        "trap         {} (poses {:.2f} times as deep as wide; two views {:.0f} degrees apart, give or take {:.0f})\n",
        TextIn(trap, "verdict"), NumberIn(trap, "depth_ratio"), NumberIn(trap, "angle_deg"),
        NumberIn(trap, "scatter_deg"));
  }
  if (IsKnown(facts, "morph")) {
    fmt::print("morph        2D poses go through a network of width {} first\n", CountIn(facts.at("morph"), "width"));
  }
  if (IsKnown(facts, "perspective")) fmt::print("perspective  {:.3f}\n", NumberIn(facts, "perspective"));
  for (const Facts& data : facts.at("data")) {
    fmt::print("data         {} (fingerprint {})\n", TextIn(data, "file"), TextIn(data, "fingerprint"));
  }
  PrintSkeleton(facts.at("skeleton"));
  PrintSource(facts.at("source"));
  fmt::print("options      {}\n", facts.at("options").dump());
}

void PrintArrays(const Facts& facts) {
  fmt::print("kind         NumPy arrays\n");
  for (const Facts& array : facts.at("arrays")) {
    fmt::print("array        {}: {}\n", TextIn(array, "name"),
               IsKnown(array, "text") ? TextIn(array, "text")
                                      : h5::FormatShape(array.at("shape").get<std::vector<std::size_t>>()));
  }
}

void PrintPoses(const Facts& facts) {
  const auto joints = facts.at("joints").get<Texts>();
  fmt::print("kind         3D poses, written by {}\n", TextIn(facts, "written_by"));
  fmt::print("poses        {} frames of {} joints in {}\n", CountIn(facts, "frames"), joints.size(),
             TextIn(facts, "units"));
  fmt::print("joints       {}\n", fmt::join(joints, ", "));
}

void PrintScene(const Facts& facts) {
  fmt::print("kind         scene: people and cameras in one world\n");
  fmt::print("scene        {}{} frames{}{}\n", IsKnown(facts, "name") ? TextIn(facts, "name") + ", " : "",
             CountIn(facts, "frames"), IsKnown(facts, "fps") ? fmt::format(" at {:g}/s", NumberIn(facts, "fps")) : "",
             IsKnown(facts, "unit") ? ", in " + TextIn(facts, "unit") : "");
  for (const char* what : {"up", "floor", "scale"}) {
    if (IsKnown(facts, what)) fmt::print("{:<12} from {}\n", what, TextIn(facts, what));
  }
  for (const Facts& person : facts.at("people")) {
    fmt::print("person       {}{} joints: {}\n", IsKnown(person, "name") ? TextIn(person, "name") + ", " : "",
               person.at("joints").size(), fmt::join(person.at("joints").get<Texts>(), ", "));
  }
  for (const Facts& camera : facts.at("cameras")) {
    const Facts& size = camera.at("image_size");
    fmt::print("camera       {}: {}x{} px{}{}\n", TextIn(camera, "name"), size.at(0).get<int>(), size.at(1).get<int>(),
               IsIn(camera, "calibrated") ? ", calibrated" : "", IsIn(camera, "used") ? "" : ", not used");
  }
}

/// What the commands print and write beside their results.
void PrintReport(const Facts& facts) {
  const std::string kind = TextIn(facts, "kind");
  if (kind == "errors") {
    fmt::print("kind         errors of single poses, written by evaluate\n");
    fmt::print("poses        {}\ncolumns      {}\n", CountIn(facts, "poses"),
               fmt::join(facts.at("columns").get<Texts>(), ", "));
  } else if (kind == "evaluation") {
    fmt::print("kind         figures, written by evaluate\nprotocol     {}\n", TextIn(facts, "protocol"));
    fmt::print("figures      N-MPJPE {:.1f} mm, PMPJPE {:.1f} mm over {} poses\n", NumberIn(facts, "n_mpjpe_mm"),
               NumberIn(facts, "p_mpjpe_mm"), CountIn(facts, "frames"));
  } else if (kind == "calibration") {
    const auto cameras = facts.at("cameras").get<Texts>();
    fmt::print("kind         calibration\ncameras      {}\n", fmt::join(cameras, ", "));
  } else {
    const bool is_solve = kind == "solve report";
    fmt::print("kind         {}, written by {}\n", is_solve ? "report" : "list of protocols",
               is_solve ? "solve" : "evaluate");
    const char* what = is_solve ? "captures" : "protocols";
    fmt::print("{:<13}{}\n", what, CountIn(facts, what));
  }
}

void PrintFacts(const Facts& facts) {
  fmt::print("file         {}\n", TextIn(facts, "file"));
  const std::string kind = TextIn(facts, "kind");
  if (kind == "dataset") {
    PrintDataset(facts);
  } else if (kind == "scene") {
    PrintScene(facts);
  } else if (kind == "npz") {
    PrintArrays(facts);
  } else if (kind == "poses") {
    PrintPoses(facts);
  } else if (kind == "model" || kind == "checkpoint") {
    PrintModel(facts);
  } else {
    PrintReport(facts);
  }
}

void RunInfo(const InfoArguments& arguments) {
  try {
    const Facts facts = FactsOf(arguments.path);
    if (arguments.json) {
      std::cout << facts.dump(2, ' ', false, Facts::error_handler_t::replace) << "\n";
    } else {
      PrintFacts(facts);
    }
  } catch (const Facts::exception&) {  // a .json that begins like one of ours
    ThrowBadInput({arguments.path.string(), "", "what canonpose writes into such a file", "other contents",
                   "write it again with the command that it comes from"});
  }
}

}  // namespace

void AddInfoCommand(CLI::App& app) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command =
      app.add_subcommand("info", "Show what a file of canonpose is, what it holds and where it came from");
  command
      ->add_option("file", arguments->path,
                   "A dataset, scene, model, run folder or checkpoint, or a .npz, .csv or .json file")
      ->required();
  command->add_flag("--json", arguments->json, "As JSON, for programs");
  command->callback([arguments] { RunInfo(*arguments); });
}

}  // namespace canonpose
