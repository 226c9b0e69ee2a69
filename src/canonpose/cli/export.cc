// canonpose export INPUT -o out.EXT
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/data/seen_by.h"
#include "canonpose/data/solved_scene.h"
#include "canonpose/export/calibration.h"
#include "canonpose/export/person_names.h"
#include "canonpose/export/scene_formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  fs::path input;
  fs::path output;
  std::string sequence;
  std::string person = "all";
  std::string up;       // empty: the format's
  std::string unit;     // empty: the format's
  std::string cameras;  // format of a calibration; empty: by the extension
  std::string names = "ours";
  std::optional<double> fps;
  FilterOptions filter;
};

/// One file to write: a scene with the people that go into it.
struct ExportJob {
  fs::path output;
  Scene scene;
  std::vector<std::vector<std::uint8_t>> seen_by;
};

std::optional<CalibrationFormat> ChosenCalibration(const ExportArguments& arguments) {
  if (arguments.cameras.empty()) {
    if (arguments.output.extension().empty()) {
      ThrowInvalidArgument(
          "{}: expected a name with an extension, which says the format: {}, or .toml or .yml for "
          "cameras; for COLMAP's folder give --cameras colmap",
          arguments.output.string(), SceneFormatNames());
    }
    return CalibrationFormatOf(arguments.output);
  }
  const std::optional<CalibrationFormat> format = FindCalibrationFormat(arguments.cameras);
  if (format) RequireCalibrationName(arguments.output, *format);
  return format;
}

const SceneFormat& ChosenSceneFormat(const ExportArguments& arguments) {
  const SceneFormat* format = FindSceneFormat(arguments.output);
  if (format != nullptr) return *format;
  ThrowInvalidArgument("{}: scenes are exported to {}, and cameras to .toml, .yml, .json or a folder (--cameras)",
                       arguments.output.string(), SceneFormatNames());
}

ExportOptions OptionsFor(const ExportArguments& arguments, UpAxis up, FileUnit unit) {
  ExportOptions options{up, unit};
  if (!arguments.up.empty()) options.up = arguments.up == "y" ? UpAxis::kY : UpAxis::kZ;
  if (!arguments.unit.empty()) options.unit = arguments.unit == "mm" ? FileUnit::kMillimetres : FileUnit::kMetres;
  if (arguments.names == "mixamo") options.joint_names = JointNames::kMixamo;
  return options;
}

/// Messages of FilterOptions name its fields, the command line has other names for them.
[[noreturn]] void ThrowWithNamesOfOptions(const Error& error) {
  std::string text = error.what();
  for (const auto& [field, option] : {std::pair<std::string, std::string>("`cutoff_hz`", "--filter"),
                                      std::pair<std::string, std::string>("`longest_gap_seconds`", "--fill-gaps")}) {
    if (const std::size_t at = text.find(field); at != std::string::npos) text.replace(at, field.size(), option);
  }
  throw Error(error.kind(), text);
}

void FilterPeople(const FilterOptions& options, Scene& scene) {
  try {
    for (PoseSequence& person : scene.people) Filter(person, options);
  } catch (const Error& error) {
    ThrowWithNamesOfOptions(error);
  }
}

std::vector<Scene> ChosenScenes(const ExportArguments& arguments) {
  std::vector<Scene> scenes = ReadScenes(arguments.input);
  std::vector<std::string> names;
  for (Scene& scene : scenes) {
    names.push_back(scene.name);
    for (PoseSequence& person : scene.people) {
      if (!arguments.fps) continue;
      if (FrameRateOf(person) > 0.0) {
        ThrowInvalidArgument("{} says that it has {:.6g} frames per second; leave out --fps", arguments.input.string(),
                             FrameRateOf(person));
      }
      person.fps = *arguments.fps;
    }
  }
  if (!arguments.sequence.empty()) {
    std::erase_if(scenes, [&](const Scene& scene) { return scene.name != arguments.sequence; });
  }
  for (Scene& scene : scenes) FilterPeople(arguments.filter, scene);
  if (!scenes.empty()) return scenes;
  ThrowBadInput({arguments.input.string(), "",
                 arguments.sequence.empty() ? "a sequence" : "a sequence " + arguments.sequence,
                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")),
                 names.empty() ? "solve a recording first" : "give --sequence " + names.front()});
}

/// The people to export, as their numbers from 0 on.
std::vector<std::size_t> ChosenPeople(const ExportArguments& arguments, const Scene& scene) {
  std::vector<std::size_t> people;
  if (arguments.person == "all") {
    for (std::size_t p = 0; p < scene.people.size(); ++p) people.push_back(p);
  } else {
    const std::string& text = arguments.person;
    const bool is_number =
        !text.empty() && text.size() <= 6 && text.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || std::stoi(text) < 1) {
      ThrowInvalidArgument("--person takes a number from 1 on, or all, not \"{}\"", text);
    }
    const auto number = static_cast<std::size_t>(std::stoi(text));
    if (number <= scene.people.size()) people.push_back(number - 1);
  }
  if (!people.empty()) return people;
  ThrowBadInput({arguments.input.string(), scene.name,
                 arguments.person == "all" ? "a person" : "a person " + arguments.person,
                 scene.people.size() == 1 ? "one person" : fmt::format("{} people", scene.people.size()),
                 "choose another with --person"});
}

/// A part of the name of a file.
std::string FileNamePart(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < 0x80 && std::isalnum(c) == 0 && c != '-' && c != '.' && c != '_'; }, '_');
  return name;
}

fs::path WithParts(const fs::path& output, const std::vector<std::string>& parts) {
  std::string name = output.stem().string();
  for (const std::string& part : parts) name += '_' + FileNamePart(part);
  return output.parent_path() / (name + output.extension().string());
}

/// Keeps some people of a scene.
ExportJob JobFor(const fs::path& output, const Scene& scene, const std::vector<std::size_t>& people,
                 const std::vector<std::vector<std::uint8_t>>& seen_by) {
  ExportJob job{output, scene, {}};
  job.scene.people.clear();
  for (const std::size_t p : people) {
    job.scene.people.push_back(scene.people[p]);
    if (p < seen_by.size()) job.seen_by.push_back(seen_by[p]);
  }
  return job;
}

/// Which cameras saw the joints of a scene's people; empty where the input does not say.
std::vector<std::vector<std::uint8_t>> SeenByOf(const Dataset& dataset, const Scene& scene) {
  const std::vector<const Sequence*> sequences = SequencesOf(dataset, scene);
  if (sequences.size() != scene.people.size()) return {};
  std::vector<std::vector<std::uint8_t>> seen_by;
  for (const Sequence* sequence : sequences) seen_by.push_back(SeenBy(*sequence));
  return seen_by;
}

std::vector<ExportJob> JobsFor(const ExportArguments& arguments, bool holds_people) {
  const std::vector<Scene> scenes = ChosenScenes(arguments);
  const Dataset dataset = IsDatasetFile(arguments.input) ? ReadDataset(arguments.input) : Dataset{};
  std::vector<ExportJob> jobs;
  for (const Scene& scene : scenes) {
    std::vector<std::string> parts;
    if (scenes.size() > 1) parts.push_back(scene.name);
    const std::vector<std::size_t> people = ChosenPeople(arguments, scene);
    const std::vector<std::vector<std::uint8_t>> seen_by = SeenByOf(dataset, scene);
    if (holds_people || people.size() == 1) {
      jobs.push_back(
          JobFor(parts.empty() ? arguments.output : WithParts(arguments.output, parts), scene, people, seen_by));
      continue;
    }
    const std::vector<std::string> names = PersonNames(scene);
    for (const std::size_t p : people) {
      std::vector<std::string> own = parts;
      own.push_back(names[p]);
      jobs.push_back(JobFor(WithParts(arguments.output, own), scene, {p}, seen_by));
    }
  }
  std::set<fs::path> outputs;
  for (const ExportJob& job : jobs) {
    RequireOutputIsNotAnInput(job.output, {arguments.input});
    if (outputs.insert(job.output).second) continue;
    ThrowInvalidArgument("{} would be written twice; choose with --sequence and --person", job.output.string());
  }
  return jobs;
}

/// "y up (known from the cameras' axes)"
std::string DescribeSpace(const Scene& scene, const FileSpace& space) {
  const std::string up =
      space.up_is_known() ? fmt::format("{} up (from {})", space.up(), scene.up.source) : "which way is up is unknown";
  const std::string scale = scene.scale.is_known() ? fmt::format(" (from {})", scene.scale.source) : "";
  return fmt::format("in {}{}; {}", space.unit(), scale, up);
}

/// One line for all files about what their numbers do not mean.
void WarnOfUnknowns(const std::vector<ExportJob>& jobs, const ExportOptions& options) {
  for (const ExportJob& job : jobs) {
    const FileSpace space(job.scene, options.up, options.unit);
    if (space.Unknowns().empty()) continue;
    std::vector<std::string> problems;
    if (!space.unit_is_known()) {
      problems.push_back(
          fmt::format("lengths are in {}, not in metres, since the size is unknown (give --height to "
                      "`canonpose solve` or `canonpose lift`)",
                      space.unit()));
    }
    if (!space.up_is_known()) problems.emplace_back("axes are those of the solution, since which way is up is unknown");
    LogWarning("{}: {}", job.output.string(), fmt::join(problems, "; "));
    return;
  }
}

void ExportScenes(const ExportArguments& arguments) {
  const SceneFormat& format = ChosenSceneFormat(arguments);
  if (!format.uses_file_space && !(arguments.up.empty() && arguments.unit.empty())) {
    ThrowInvalidArgument("{} files have axes and units of their own; leave out --up and --unit", format.extension);
  }
  ExportOptions options = OptionsFor(arguments, format.up, format.unit);
  const std::vector<ExportJob> jobs = JobsFor(arguments, format.holds_people);
  for (const ExportJob& job : jobs) {
    if (!format.needs_frame_rate || FrameRateOf(job.scene.people.front()) > 0.0) continue;
    ThrowBadInput({arguments.input.string(), job.scene.name,
                   "a frame rate, which " + std::string(format.extension) + " files state", "none",
                   "give it with --fps"});
  }
  if (format.uses_file_space) WarnOfUnknowns(jobs, options);
  for (const ExportJob& job : jobs) {
    options.seen_by = job.seen_by;
    options.processing = Describe(arguments.filter);
    format.write(job.output, job.scene, options);
    const PoseSequence& first = job.scene.people.front();
    LogInfo("{}: {} frames of {} joints{}{}", job.output.string(), first.frame_count(), first.joint_count(),
            job.scene.people.size() > 1 ? fmt::format(" of {} people", job.scene.people.size()) : "",
            format.uses_file_space ? ", " + DescribeSpace(job.scene, {job.scene, options.up, options.unit}) : "");
  }
}

void ExportCameras(const ExportArguments& arguments, CalibrationFormat format) {
  ExportOptions options = OptionsFor(arguments, UpAxis::kZ, FileUnit::kMetres);
  if (format == CalibrationFormat::kPose2Sim && options.unit == FileUnit::kMillimetres) {
    ThrowInvalidArgument("Pose2Sim's calibrations are in metres; leave out --unit, or choose another of --cameras");
  }
  const std::vector<ExportJob> jobs = JobsFor(arguments, true);
  WarnOfUnknowns(jobs, options);
  for (const ExportJob& job : jobs) {
    const FileSpace space(job.scene, options.up, options.unit);
    WriteCalibration(job.output, format, job.scene, space);
    const std::vector<std::string> missing = CamerasWithoutCalibration(job.scene);
    LogInfo("{}: {} cameras{}, {}", job.output.string(), job.scene.cameras.size() - missing.size(),
            missing.empty() ? "" : fmt::format(" (not {}, which were not found)", fmt::join(missing, ", ")),
            DescribeSpace(job.scene, space));
  }
}

void RunExport(const ExportArguments& arguments) {
  if (arguments.fps && !(std::isfinite(*arguments.fps) && *arguments.fps > 0.0)) {
    ThrowInvalidArgument("--fps: expected frames per second, above 0, found {}", *arguments.fps);
  }
  if (const std::optional<CalibrationFormat> calibration = ChosenCalibration(arguments)) {
    return ExportCameras(arguments, *calibration);
  }
  ExportScenes(arguments);
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command =
      app.add_subcommand("export", "Write solved or lifted poses, joint angles and cameras as files of other programs");
  command
      ->add_option("input", arguments->input,
                   "A dataset written by solve, a scene, or what lift wrote (.npz, .json, .h5)")
      ->required();
  std::string formats;
  for (const SceneFormat& format : SceneFormats())
    formats += fmt::format("{} ({}), ", format.extension, format.contents);
  command
      ->add_option(
          "-o,--output", arguments->output,
          "Where to write: " + formats + "or cameras: .toml (Pose2Sim), .yml (OpenCV), and others by --cameras")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--cameras", arguments->cameras,
                   "Write the cameras, in this format: pose2sim, anipose (.toml), opencv (.yml), colmap (a folder), or "
                   "json, which import --calibration reads like all others but colmap")
      ->check(CLI::IsMember({"pose2sim", "opencv", "anipose", "colmap", "json"}));
  command
      ->add_option("--up", arguments->up,
                   "The axis that points up (default: y in .trc, .mot and .sto, as OpenSim has it, otherwise z)")
      ->check(CLI::IsMember({"y", "z"}));
  command->add_option("--unit", arguments->unit, "The unit of lengths (default: mm in .c3d, otherwise m)")
      ->check(CLI::IsMember({"mm", "m"}));
  command->add_option("--names", arguments->names, "Of joints in .bvh and .glb: ours, or those of Mixamo")
      ->check(CLI::IsMember({"ours", "mixamo"}));
  command->add_option("--sequence", arguments->sequence,
                      "Which sequence, if the input holds several (default: a file for each, with its name)");
  command
      ->add_option("--person", arguments->person,
                   "Which person, counted from 1, or all: in one file where the format holds several, otherwise a file "
                   "for each")
      ->capture_default_str()
      ->type_name("N|all");
  command
      ->add_option("--filter", arguments->filter.cutoff_hz,
                   "Low-pass filter at this many Hz, a Butterworth filter without delay; 6 is usual for walking "
                   "(default: none)")
      ->type_name("HZ");
  command
      ->add_option("--fill-gaps", arguments->filter.longest_gap_seconds,
                   "Fill gaps up to this long before (default: none)")
      ->type_name("SECONDS");
  command->add_option("--fps", arguments->fps, "Frames per second, if the input does not know them")->type_name("FPS");
  command->callback([arguments] { RunExport(*arguments); });
}

}  // namespace canonpose
