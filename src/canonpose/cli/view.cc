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
  StripOptions strip;
};

/// What `solve --json` wrote. The page would show nothing of another file, so that is refused.
std::string ReadSolveReport(const fs::path& path) {
  const std::string text = ReadFile(path);
  const nlohmann::json report = nlohmann::json::parse(text, nullptr, false);
  if (!report.is_object() || !report.contains("captures") || !report["captures"].is_array()) {
    ThrowBadInput({path.string(), "", "a report that `canonpose solve --json` wrote", "something else",
                   "solve with --json, and give that file"});
  }
  return text;
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

/// Throws where a report is of other captures than a solved dataset.
void RequireReportOf(const fs::path& input, const fs::path& report_path, const std::string& report) {
  if (!IsDatasetFile(input)) return;
  std::set<std::string> captures;
  for (const Sequence& sequence : ReadDataset(input).sequences) captures.insert(sequence.capture);
  std::vector<std::string> reported;
  const nlohmann::json parsed = nlohmann::json::parse(report);
  for (const nlohmann::json& capture : parsed["captures"]) reported.push_back(capture.value("name", ""));
  if (std::ranges::any_of(reported, [&](const std::string& name) { return captures.contains(name); })) return;
  ThrowBadInput(
      {report_path.string(), "", fmt::format("the report of {} ({})", input.string(), fmt::join(captures, ", ")),
       fmt::format("that of {}", fmt::join(reported, ", ")), "give the one that `canonpose solve` wrote with it"});
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
  std::vector<ShownResult> results;
  for (std::size_t i = 0; i < arguments.inputs.size(); ++i) {
    results.push_back(ReadShownResult(arguments.inputs[i]));
    if (i >= arguments.reports.size()) continue;
    results.back().solve_report = ReadSolveReport(arguments.reports[i]);
    RequireReportOf(arguments.inputs[i], arguments.reports[i], results.back().solve_report);
  }
  if (!arguments.strip.frames.empty()) {
    WriteFileAtomically(arguments.output, SkeletonStrip(results, arguments.strip));
    std::cout << arguments.output.string() << ": a strip of " << arguments.strip.frames.size() << " frames\n"
              << std::flush;
    return;
  }
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
