// canonpose import FORMAT PATH... -o data.h5
#include "canonpose/data/import.h"

#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/with_torch.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

/// The command line as given; texts are parsed when the command runs, so that all error messages have the same form.
struct ImportArguments {
  ImportOptions options;
  std::vector<std::string> paths;
  std::vector<std::string> cameras;      // NAME=PATH
  std::vector<std::string> image_sizes;  // WxH or NAME=WxH
  std::vector<std::string> people;       // N or NAME=N
  std::vector<std::string> rates;        // FPS or NAME=FPS
  std::string align = "automatic";
  std::string calibration;
  std::string morph;
  std::string skeleton;  // empty: the format's usual one
  std::string truth;
  std::vector<std::string> chosen_cameras;
  std::string output;
};

/// "NAME=VALUE" as its two halves; the name is empty where there is no '='.
std::pair<std::string, std::string> SplitNameAndPath(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {"", text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

int ParsePerson(const std::string& text) {
  if (text.empty() || text.size() > 6 || text.find_first_not_of("0123456789") != std::string::npos ||
      std::stoi(text) < 1) {
    ThrowInvalidArgument("--person takes a number from 1 on, NAME=NUMBER for one camera, or all, not \"{}\"", text);
  }
  return std::stoi(text);
}

double ParseRate(const std::string& text) {
  double rate = 0.0;
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, rate);
  if (error != std::errc() || after != end || !std::isfinite(rate) || rate <= 0.0) {
    ThrowInvalidArgument("--fps: expected frames per second, above 0, found {}", text);
  }
  return rate;
}

ImportOptions ToOptions(const ImportArguments& arguments) {
  ImportOptions options = arguments.options;
  options.paths.assign(arguments.paths.begin(), arguments.paths.end());
  for (const std::string& text : arguments.cameras) {
    const auto [name, path] = SplitNameAndPath(text);
    if (!name.empty() && !path.empty()) {
      options.cameras.push_back({name, path});
    } else if (name.empty() && text == path) {
      options.paths.emplace_back(text);  // a PATH that follows the option
    } else {
      ThrowInvalidArgument("--camera takes NAME=PATH, not \"{}\"", text);
    }
  }
  for (const std::string& text : arguments.image_sizes) {
    const auto [name, size] = SplitNameAndPath(text);
    (name.empty() ? options.image_size : options.camera_image_size[name]) = ParseImageSize(size);
  }
  for (const std::string& text : arguments.people) {
    if (text == "all") {
      options.everybody = true;
      continue;
    }
    const auto [name, number] = SplitNameAndPath(text);
    (name.empty() ? options.person : options.camera_person[name]) = ParsePerson(number);
  }
  for (const std::string& text : arguments.rates) {
    const auto [name, rate] = SplitNameAndPath(text);
    (name.empty() ? options.fps : options.camera_fps[name]) = ParseRate(rate);
  }
  options.calibration = arguments.calibration;
  if (!arguments.skeleton.empty()) options.skeleton = arguments.skeleton;
  options.alignment = arguments.align == "frame-number" ? FrameAlignment::kFrameNumber
                      : arguments.align == "order"      ? FrameAlignment::kOrder
                      : arguments.align == "none"       ? FrameAlignment::kNone
                                                        : FrameAlignment::kAutomatic;
  if (options.name.empty()) {
    options.name = std::filesystem::path(arguments.output).stem().string();
    if (options.name.empty() || options.name.front() == '.') options.name = "clip";
  }
  return options;
}

/// Refuses options that this kind of format does not have, rather than ignoring them.
void RefuseOptions(const CLI::App& command, const std::vector<const char*>& options, const std::string& format) {
  for (const char* const option : options) {
    if (command.count(option) > 0) ThrowInvalidArgument("{} has no meaning for {}", option, format);
  }
}

BenchmarkOptions ToBenchmarkOptions(const ImportArguments& arguments, const CLI::App& command) {
  const std::string& format = arguments.options.format;
  RefuseOptions(command, {"--camera", "--person", "--align", "--name", "--subject", "--capture", "--moving"}, format);
  BenchmarkOptions options;
  options.format = format;
  options.paths.assign(arguments.paths.begin(), arguments.paths.end());
  options.calibration = arguments.calibration;
  options.skeleton = arguments.skeleton;
  options.layout = arguments.options.layout;
  options.truth = arguments.truth;
  options.cameras = arguments.chosen_cameras;
  for (const std::string& rate : arguments.rates) options.fps = ParseRate(rate);
  for (const std::string& size : arguments.image_sizes) options.image_size = ParseImageSize(size);
  return options;
}

/// "cam1 3, cam2 4": how many tracks each camera has.
std::string TracksSeen(const Sequence& sequence) {
  std::string cameras;
  for (const CameraView& view : sequence.cameras) {
    cameras += fmt::format("{}{} {}", cameras.empty() ? "" : ", ", view.name, view.tracks.size());
  }
  return cameras;
}

/// "cam1 98.1 %, cam2 97.0 %": how much each camera sees of the person.
std::string SharesSeen(const Sequence& sequence) {
  std::string cameras;
  for (const CameraView& view : sequence.cameras) {
    long seen = 0;
    for (const float confidence : view.confidence) seen += confidence > 0.0F ? 1 : 0;
    const double share = static_cast<double>(seen) / static_cast<double>(view.confidence.size());
    cameras += fmt::format("{}{} {:.1f} %", cameras.empty() ? "" : ", ", view.name, 100.0 * share);
  }
  return cameras;
}

void LogSummary(const Dataset& dataset, const std::string& output) {
  const Sequence& sequence = dataset.sequences.front();
  std::string derived;
  for (const std::string& joint : dataset.source.mapping) {
    if (joint.find(" = mean(") != std::string::npos) derived += (derived.empty() ? "" : ", ") + joint;
  }
  const bool has_tracks = sequence.HasTracks();
  LogInfo("{}: {} frames from {} cameras; {}: {}", output, sequence.frame_count, sequence.cameras.size(),
          has_tracks ? "tracks of people" : "joints seen", has_tracks ? TracksSeen(sequence) : SharesSeen(sequence));
  LogInfo("layout {}, {} joints; derived: {}", dataset.source.layout, dataset.skeleton.joint_count(),
          derived.empty() ? "none" : derived);
  const Skeleton* layout = FindSkeleton(dataset.source.layout);
  if (layout != nullptr && layout->Find("LBigToe") && !dataset.skeleton.Find("LBigToe")) {
    LogInfo("heels and toes are left out; --skeleton native keeps them, which angles of the ankle need");
  }
  LogInfo("sequence {}, subject {}, capture {}, {} cameras", sequence.name, sequence.subject, sequence.capture,
          sequence.static_cameras ? "static" : "moving");
}

/// What would end minutes of work in an error is found before: a name of another kind of file, an input that would be
/// overwritten, a place that cannot be written.
void CheckOutput(const ImportArguments& arguments) {
  RequireDatasetName(arguments.output);
  std::vector<std::filesystem::path> inputs(arguments.paths.begin(), arguments.paths.end());
  for (const std::string& camera : arguments.cameras) inputs.emplace_back(SplitNameAndPath(camera).second);
  inputs.emplace_back(arguments.calibration);
  inputs.emplace_back(arguments.morph);
  inputs.emplace_back(arguments.options.layout);
  RequireOutputIsNotAnInput(arguments.output, inputs);
  const AtomicFile probe(arguments.output);
}

void RunBenchmarkImport(const ImportArguments& arguments, const CLI::App& command) {
  const BenchmarkOptions options = ToBenchmarkOptions(arguments, command);
  options.Validate();
  CheckOutput(arguments);
  Dataset dataset = ImportBenchmark(options);
  if (!arguments.morph.empty()) ApplyMorph(arguments.morph, dataset, arguments.output);
  WriteDataset(arguments.output, dataset);
  LogInfo("{}: {} sequences; {}, {}", arguments.output, dataset.sequences.size(),
          dataset.HasTruth() ? "with truth" : "without truth",
          dataset.HasCalibration() ? "with calibrated cameras" : "without calibration");
}

void RunImport(const ImportArguments& arguments, const CLI::App& command) {
  const std::string& format = arguments.options.format;
  if (FindBenchmarkFormat(format) != nullptr) return RunBenchmarkImport(arguments, command);
  RefuseOptions(command, {"--truth", "--cameras"}, format + ", which is not a benchmark");
  const ImportOptions options = ToOptions(arguments);
  options.Validate();
  if (options.everybody && !arguments.morph.empty()) {
    ThrowInvalidArgument("--morph moves the joints of one person; leave it out with --person all");
  }
  CheckOutput(arguments);
  Dataset dataset = ImportDetections(options);
  if (!arguments.morph.empty()) ApplyMorph(arguments.morph, dataset, arguments.output);
  WriteDataset(arguments.output, dataset);
  LogSummary(dataset, arguments.output);
}

}  // namespace

void AddImportCommand(CLI::App& app) {
  auto arguments = std::make_shared<ImportArguments>();
  arguments->options.name.clear();
  ImportOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand(
      "import", "Make a dataset from a detector's 2D keypoints of at least two cameras, or from a benchmark's files");
  command
      ->add_option("format", options.format,
                   "The detector's files: " + DetectionFormatNames() + "; or a benchmark's: " + BenchmarkFormatNames())
      ->required()
      ->type_name("FORMAT");
  command
      ->add_option("path", arguments->paths,
                   "One folder or file per camera, or a folder that holds them; for a benchmark, its files")
      ->type_name("PATH");
  command->add_option("-o,--output", arguments->output, "The dataset to write")->required()->type_name("FILE");
  command->add_option("--camera", arguments->cameras, "A camera under a name of your choice; may be repeated")
      ->type_name("NAME=PATH");
  command
      ->add_option("--image-size", arguments->image_sizes,
                   "Width and height in pixels of all cameras, or of the one named")
      ->type_name("[NAME=]WxH")
      ->allow_extra_args(false);
  command
      ->add_option("--calibration", arguments->calibration,
                   "Calibration as JSON, of Pose2Sim or aniposelib (.toml), OpenCV (.yml) or Qualisys (.qca.txt), or, "
                   "for 3dhp-train, "
                   "camera.calibration; for evaluation only, training does not use it")
      ->type_name("FILE");
  command
      ->add_option(
          "--layout", options.layout,
          "The detector's layout (default: what the files say, or recognised by the number of keypoints and anatomy), "
          "or a "
          "JSON file with the joints, parents, mirror and root of a skeleton of your own, such as an animal's. "
          "canonpose-detections: canonpose-16 (default) or mpii-16")
      ->type_name("NAME|FILE");
  command
      ->add_option("--skeleton", arguments->skeleton,
                   "The skeleton to map to, or native for the detector's or benchmark's own joints (default: h36m-17; "
                   "native for "
                   "animals and for canonpose-detections)")
      ->type_name("NAME");
  command
      ->add_option("--cameras", arguments->chosen_cameras,
                   "The cameras of a benchmark to keep, such as 0,2,4,7,8 (default: all)")
      ->type_name("NAME,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--truth", arguments->truth,
                   "Which poses of MPI-INF-3DHP are the truth: annot3, in their true size (default of 3dhp-train), or "
                   "univ_annot3, scaled to one height, which published results compare with (default of 3dhp-test)")
      ->type_name("NAME");
  command
      ->add_option("--morph", arguments->morph,
                   "Move the joints with this morphing network (train-morph) to where another skeleton has them")
      ->type_name("RUN");
  command
      ->add_option("--person", arguments->people,
                   "Whom to follow if several people are seen: 1 is the most prominent (default); all: everybody, whom "
                   "solve then tells apart")
      ->type_name("[NAME=]N|all")
      ->allow_extra_args(false);
  command
      ->add_option("--align", arguments->align,
                   "Match the cameras' frames by the numbers or times in their names, in order, or (automatic) in "
                   "order only where the numbers have nothing in common; or none: nobody synchronised the cameras, and "
                   "solve finds when each began")
      ->check(CLI::IsMember({"automatic", "order", "frame-number", "none"}))
      ->capture_default_str();
  command->add_option("--name", options.name, "Name of the sequence (default: the output's name)")->type_name("NAME");
  command->add_option("--subject", options.subject, "Name of the person (default: the sequence's name)")
      ->type_name("NAME");
  command
      ->add_option("--capture", options.capture,
                   "Recordings of one capture share their cameras (default: this one alone)")
      ->type_name("NAME");
  command
      ->add_option(
          "--fps", arguments->rates,
          "Frames per second of all cameras, or of the one named (default: from video.json, or frames named by "
          "the time)")
      ->type_name("[NAME=]FPS")
      ->allow_extra_args(false);
  command->add_flag("--moving", options.moving_cameras, "The cameras move");
  command->callback([arguments, command] { RunImport(*arguments, *command); });
}

}  // namespace canonpose
