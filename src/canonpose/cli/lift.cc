// canonpose lift RUN|model.cpm INPUT -o out.npz
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/import.h"
#include "canonpose/export/lift_output.h"
#include "canonpose/lift/lifter.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct LiftArguments {
  fs::path model;
  fs::path input;
  fs::path output;
  std::string camera;
  std::string sequence;
  std::string frames;
  std::string format;
  std::string layout;
  std::string image_size;
  int person = 1;
  std::optional<double> height_m;
  std::optional<int> smooth_frames;
  std::string device = "cpu";
};

/// The 2D poses to lift, and the numbers of their frames.
struct LiftInput {
  CameraView view;
  std::vector<std::int64_t> frames;
  double fps = 0.0;
};

/// The element of that name, or the only one where no name is given.
template <typename Element>
const Element& Choose(const std::vector<Element>& elements, const std::string& name, const std::string& option,
                      const std::string& file) {
  std::string names;
  for (const Element& element : elements) {
    if (element.name == name || (name.empty() && elements.size() == 1)) return element;
    names += (names.empty() ? "" : ", ") + element.name;
  }
  ThrowBadInput({file, "", name.empty() ? "one " + option : option + " " + name, names, "choose one with --" + option});
}

LiftInput FromDataset(const LiftArguments& arguments, const PoseLifter& lifter) {
  Dataset dataset = ReadDataset(arguments.input);
  lifter.RequireSkeleton(dataset.skeleton, arguments.input.string());
  const FrameRange range = arguments.frames.empty() ? FrameRange{} : FrameRange::Parse(arguments.frames);
  if (!arguments.frames.empty()) KeepFrames(dataset, range, arguments.input.string());
  const Sequence& sequence = Choose(dataset.sequences, arguments.sequence, "sequence", arguments.input.string());
  LiftInput input{Choose(sequence.cameras, arguments.camera, "camera", arguments.input.string()), {}, sequence.fps};
  input.frames.resize(static_cast<std::size_t>(sequence.frame_count));
  std::iota(input.frames.begin(), input.frames.end(), range.first);
  return input;
}

LiftInput FromDetections(const LiftArguments& arguments, const PoseLifter& lifter) {
  const DatasetSource& source = lifter.info().source;
  SingleCameraOptions options;
  options.format = arguments.format;
  options.layout = arguments.layout.empty() ? source.layout : arguments.layout;
  // Confidences must mean what they meant in training; other detectors have scales of their own.
  options.confidence_scale = options.layout == source.layout ? source.confidence_scale : 0.0;
  options.skeleton = lifter.skeleton();
  options.camera = arguments.camera;
  options.person = arguments.person;
  if (!arguments.image_size.empty()) options.image_size = ParseImageSize(arguments.image_size);
  SingleCamera single = ReadSingleCamera(arguments.input, options);
  return {std::move(single.view), std::move(single.frame_numbers), single.fps};
}

/// Options that would be ignored are a misunderstanding.
void RefuseMisplacedOptions(const LiftArguments& arguments, bool is_dataset) {
  const auto refuse = [&](bool given, const char* option) {
    if (given)
      ThrowInvalidArgument("{} is for {}, and {} is not one", option, is_dataset ? "a detector's files" : "datasets",
                           arguments.input.string());
  };
  refuse(!is_dataset && !arguments.frames.empty(), "--frames");
  refuse(!is_dataset && !arguments.sequence.empty(), "--sequence");
  refuse(is_dataset && !arguments.format.empty(), "--format");
  refuse(is_dataset && !arguments.layout.empty(), "--layout");
  refuse(is_dataset && !arguments.image_size.empty(), "--image-size");
  refuse(is_dataset && arguments.person != 1, "--person");
}

void RunLift(const LiftArguments& arguments) {
  RequireLiftFormat(arguments.output);
  if (arguments.height_m && !(*arguments.height_m > 0.0 && *arguments.height_m < 10.0)) {
    ThrowInvalidArgument("--height: expected the person's height in metres, such as 1.75, found {}",
                         *arguments.height_m);
  }
  if (arguments.smooth_frames && *arguments.smooth_frames < kMinSmoothing) {
    ThrowInvalidArgument("--smooth: expected {} frames or more, found {}", kMinSmoothing, *arguments.smooth_frames);
  }
  if (!fs::exists(arguments.input)) {
    ThrowBadInput({arguments.input.string(), "", "a dataset or a detector's files", "nothing", "check the path"});
  }
  const bool is_dataset = IsDatasetFile(arguments.input);
  RefuseMisplacedOptions(arguments, is_dataset);
  const PoseLifter lifter = PoseLifter::Open(arguments.model, arguments.device);
  LiftInput input = is_dataset ? FromDataset(arguments, lifter) : FromDetections(arguments, lifter);
  LiftedPoses lifted = lifter.Lift(input.view, static_cast<int>(input.frames.size()));
  if (arguments.height_m) ScaleToHeight(lifted, lifter.skeleton(), 1000.0 * *arguments.height_m);
  if (arguments.smooth_frames) Smooth(lifted, input.frames, *arguments.smooth_frames);

  LiftOutput output;
  output.pose3d = std::move(lifted.pose_in_camera);
  output.canonical = std::move(lifted.canonical);
  output.rotation = std::move(lifted.rotation);
  output.joints = lifter.skeleton().joints;
  output.frames = std::move(input.frames);
  output.units = arguments.height_m ? "mm" : "network units";
  output.fps = input.fps;
  WriteLiftOutput(arguments.output, output);

  long missing = 0;
  for (std::size_t t = 0; t < output.frames.size(); ++t) missing += std::isnan(output.rotation[9 * t]) ? 1 : 0;
  LogInfo("{}: {} poses of {} in {}{}", arguments.output.string(),
          output.frames.size() - static_cast<std::size_t>(missing),
          input.view.name.empty() ? arguments.input.string() : input.view.name, output.units,
          missing > 0 ? fmt::format("; {} frames without a usable 2D pose are left empty", missing) : "");
}

}  // namespace

void AddLiftCommand(CLI::App& app) {
  auto arguments = std::make_shared<LiftArguments>();
  CLI::App* command = app.add_subcommand("lift", "Lift the 2D poses of a single camera to 3D");
  command->add_option("model", arguments->model, "A model file, or the folder of a finished run")->required();
  command->add_option("input", arguments->input, "A dataset, or a detector's files of one camera")->required();
  command->add_option("-o,--output", arguments->output, "Where to write: .npz, .csv or .json")->required();
  command->add_option("--camera", arguments->camera, "Which camera, where the input holds several");
  command->add_option("--sequence", arguments->sequence, "Which sequence, where the dataset holds several");
  command->add_option("--frames", arguments->frames, "Frames A-B of the dataset only, counted from 0");
  command->add_option("--height", arguments->height_m,
                      "The person's height in metres: the output is then in millimetres");
  command->add_option("--smooth", arguments->smooth_frames,
                      "Smooth a video's poses over so many frames, such as 9 at 30 frames a second (default: not)");
  command->add_option("--person", arguments->person, "Whom to follow in a detector's files: 1 is the most prominent")
      ->check(CLI::PositiveNumber);
  command->add_option("--format", arguments->format, "Format of a detector's files (default: told from their content)");
  command->add_option("--layout", arguments->layout,
                      "Layout of a detector's files (default: that of the training data)");
  command->add_option("--image-size", arguments->image_size,
                      "WxH in pixels of a detector's files, for models trained with ray=root");
  command->add_option("--device", arguments->device, "cpu or cuda (default cpu)");
  command->callback([arguments] { RunLift(*arguments); });
}

}  // namespace canonpose
