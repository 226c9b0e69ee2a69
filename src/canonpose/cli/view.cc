// canonpose view INPUT... -o page.html
// canonpose view INPUT... --svg FRAME[,FRAME...] -o strip.svg
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/evaluate_datasets.h"
#include "canonpose/view/page.h"
#include "canonpose/view/page_content.h"
#include "canonpose/view/skeleton_strip.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::vector<fs::path> inputs;
  std::vector<fs::path> reports;
  fs::path output;
  std::string title;  // empty: the inputs' names
  StripOptions strip;
};

/// What `solve --json` wrote of one of these captures, or of any where none are known. The page would show nothing of
/// another file, and a report of another recording says nothing about this one, so both are refused.
std::string ReadSolveReport(const fs::path& path, const std::set<std::string>& captures) {
  const std::string text = ReadFile(path);
  const nlohmann::json report = nlohmann::json::parse(text, nullptr, false);
  if (!report.is_object() || !report.contains("captures") || !report["captures"].is_array()) {
    ThrowBadInput({path.string(), "", "a report that `canonpose solve --json` wrote", "something else",
                   "solve with --json, and give that file"});
  }
  std::vector<std::string> reported;
  for (const nlohmann::json& capture : report["captures"]) {
    if (capture.is_object()) reported.push_back(capture.value("name", ""));
  }
  if (captures.empty() || std::ranges::any_of(reported, [&](const auto& name) { return captures.contains(name); })) {
    return text;
  }
  ThrowBadInput({path.string(), "", fmt::format("the report of {}", fmt::join(captures, ", ")),
                 fmt::format("that of {}", fmt::join(reported, ", ")),
                 "give the one that `canonpose solve` wrote with this dataset"});
}

/// What `evaluate` says of a solved dataset; empty where there is nothing to compare with, or the comparison fails,
/// which is no reason not to look at the poses.
std::string Evaluate(const fs::path& path) {
  if (!IsDatasetFile(path)) return "";
  const Dataset dataset = ReadDataset(path);
  if (!dataset.HasTruth() && !dataset.HasCalibration()) return "";
  DatasetEvaluation job;
  job.files = {path};
  job.protocol = FindProtocol(kAllFrames);
  job.with_cameras = true;
  try {
    return ReportAsJson(EvaluateDatasets(job, SolvedPoses()));
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kStopped) throw;
    LogWarning("the page has no errors of {}: {}", path.string(), error.what());
    return "";
  }
}

void RequireOutputName(const fs::path& output, bool is_image) {
  const std::string extension = LowerCase(output.extension().string());
  if (is_image ? extension == ".svg" : extension == ".html" || extension == ".htm") return;
  ThrowInvalidArgument("{}: expected a name that ends in {}", output.string(),
                       is_image ? ".svg, since --svg is given" : ".html, or --svg FRAMES for an image (.svg)");
}

void RunView(const ViewArguments& arguments) {
  RequireOutputName(arguments.output, !arguments.strip.frames.empty());
  std::vector<fs::path> read = arguments.inputs;
  read.insert(read.end(), arguments.reports.begin(), arguments.reports.end());
  RequireOutputIsNotAnInput(arguments.output, read);
  if (arguments.reports.size() > arguments.inputs.size()) {
    ThrowInvalidArgument("{} reports for {} inputs: give one for each, in their order", arguments.reports.size(),
                         arguments.inputs.size());
  }
  if (!arguments.title.empty() && arguments.inputs.size() != 1) {
    ThrowInvalidArgument("--title is for one input; several are told apart by their names");
  }
  std::vector<ShownResult> results;
  for (std::size_t i = 0; i < arguments.inputs.size(); ++i) {
    results.push_back(ReadShownResult(arguments.inputs[i]));
    if (i < arguments.reports.size()) {
      std::set<std::string> captures;
      for (const ShownScene& shown : results.back().scenes) captures.insert(shown.capture);
      captures.erase("");
      results.back().solve_report = ReadSolveReport(arguments.reports[i], captures);
    }
  }
  if (!arguments.strip.frames.empty()) {
    WriteFileAtomically(arguments.output, SkeletonStrip(results, arguments.strip));
    std::cout << arguments.output.string() << ": a strip of " << arguments.strip.frames.size() << " frames\n"
              << std::flush;
    return;
  }
  if (!arguments.title.empty()) results.front().name = arguments.title;
  for (std::size_t i = 0; i < results.size(); ++i) results[i].evaluation = Evaluate(arguments.inputs[i]);
  const std::string page = MakePage(results);
  WriteFileAtomically(arguments.output, page);
  constexpr double kMebibyte = 1024.0 * 1024.0;
  std::cout << fmt::format("{}: {:.1f} MiB; open it in a browser\n", arguments.output.string(),
                           static_cast<double>(page.size()) / kMebibyte)
            << std::flush;
}

}  // namespace

void AddViewCommand(CLI::App& app) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command =
      app.add_subcommand("view", "Make a web page that shows 3D poses and cameras, in one file that needs no network");
  command
      ->add_option(
          "input", arguments->inputs,
          "Solved datasets or scene files; several are shown side by side, such as two solutions of a recording")
      ->required();
  command->add_option("-o,--output", arguments->output, "Page to write (.html), or with --svg the image (.svg)")
      ->required();
  command
      ->add_option("--report", arguments->reports,
                   "What solve wrote with --json, to be shown in the page: one for each input, in their order")
      ->allow_extra_args(false);
  command->add_option("--title", arguments->title, "What the page is called (default: the input's name)")
      ->type_name("NAME");
  command
      ->add_option("--svg", arguments->strip.frames,
                   "Write these frames, counted from 0, as a strip of skeletons instead: A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--view-angle", arguments->strip.view_angle_deg,
                   "With --svg, where to look from in degrees: 0 in front of the person, 90 from the person's left")
      ->capture_default_str();
  command->add_option("--scene", arguments->strip.scene, "With --svg, which sequence of the file, counted from 0")
      ->capture_default_str();
  command->callback([arguments] { RunView(*arguments); });
}

}  // namespace canonpose
