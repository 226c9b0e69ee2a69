// canonpose lift RUN|model.cpm INPUT -o out.npz
#include <algorithm>
#include <climits>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/import.h"
#include "canonpose/export/lift_output.h"
#include "canonpose/lift/pose_lifter.h"

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
  bool fill = false;
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

/// Keypoints must mean what they meant in training: moved by the same morphing network, or by none.
void WarnOfOtherMorph(const ModelInfo& model, const DatasetSource& source, const std::string& file) {
  if (model.source.morph == source.morph) return;
  const auto describe = [](const std::string& morph) { return morph.empty() ? "nothing" : morph; };
  LogWarning(
      "{}: its keypoints were moved by {} when they were imported, those that the model learned from by {}: 3D "
      "poses will be off; import them in the same way (`morph`)",
      file, describe(source.morph), describe(model.source.morph));
}

LiftInput FromDataset(const LiftArguments& arguments, const PoseLifter& lifter) {
  Dataset dataset = ReadDataset(arguments.input);
  lifter.RequireSkeleton(dataset.skeleton, arguments.input.string());
  WarnOfOtherMorph(lifter.info(), dataset.source, arguments.input.string());
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
  // Confidences must have the scale that they had in training; other detectors have other scales.
  options.confidence_scale = options.layout == source.layout ? source.confidence_scale : 0.0;
  options.skeleton = lifter.skeleton();
  options.camera = arguments.camera;
  options.person = arguments.person;
  if (!arguments.image_size.empty()) options.image_size = ParseImageSize(arguments.image_size);
  SingleCamera single = ReadSingleCamera(arguments.input, options);
  WarnOfOtherMorph(lifter.info(), single.source, arguments.input.string());
  return {std::move(single.view), std::move(single.frame_numbers), single.fps};
}

/// Refuses options that would be ignored.
void RefuseMisplacedOptions(const LiftArguments& arguments, bool is_dataset) {
  const auto refuse = [&](bool given, const char* option) {
    if (given) {
      ThrowInvalidArgument("{} is for {}, and {} is not one", option, is_dataset ? "a detector's files" : "datasets",
                           arguments.input.string());
    }
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
  RequireOutputIsNotAnInput(arguments.output, {arguments.model, arguments.input});
  if (arguments.height_m) RequireHeight(*arguments.height_m);
  if (arguments.smooth_frames) RequireSmoothing(*arguments.smooth_frames, INT_MAX);
  if (!fs::exists(arguments.input)) {
    ThrowBadInput({arguments.input.string(), "", "a dataset or a detector's files", "nothing", "check the path"});
  }
  const bool is_dataset = IsDatasetFile(arguments.input);
  RefuseMisplacedOptions(arguments, is_dataset);
  const PoseLifter lifter = PoseLifter::Open(arguments.model, arguments.device);
  for (const std::string& doubt : DoubtsAbout(lifter.info())) {
    LogWarning("{}: do not rely on these 3D poses: {}", arguments.model.string(), doubt);
  }
  LiftInput input = is_dataset ? FromDataset(arguments, lifter) : FromDetections(arguments, lifter);
  if (arguments.smooth_frames) RequireSmoothing(*arguments.smooth_frames, static_cast<int>(input.frames.size()));
  lifter.RequireImageSize(input.view, arguments.input.string());
  LiftedPoses lifted = lifter.Lift(input.view, static_cast<int>(input.frames.size()));
  lifted.frames = std::move(input.frames);
  lifted.pose_in_camera.fps = lifted.canonical.fps = input.fps;
  if (arguments.height_m) ScaleToHeight(lifted, 1000.0 * *arguments.height_m);
  if (!arguments.fill) lifted.HideUnseenJoints();
  if (arguments.smooth_frames) Smooth(lifted, *arguments.smooth_frames);
  WriteLiftOutput(arguments.output, lifted);

  const long unseen = std::ranges::count(lifted.pose_in_camera.confidence(), 0.0F);
  long missing = 0;
  for (std::size_t t = 0; t < lifted.frames.size(); ++t) missing += std::isnan(lifted.rotation[9 * t]) ? 1 : 0;
  const long unseen_joints = unseen - missing * lifted.joint_count();
  LogInfo("{}: {} poses of {} in {}{}{}", arguments.output.string(),
          lifted.frames.size() - static_cast<std::size_t>(missing),
          input.view.name.empty() ? arguments.input.string() : input.view.name, UnitsInFile(lifted),
          missing > 0 ? fmt::format("; {} frames without a usable 2D pose are left empty", missing) : "",
          unseen_joints > 0 ? fmt::format("; {} joints were not seen and are {}", unseen_joints,
                                          arguments.fill ? "guesses with confidence 0" : "left empty")
                            : "");
}

}  // namespace

void AddLiftCommand(CLI::App& app) {
  auto arguments = std::make_shared<LiftArguments>();
  CLI::App* command = app.add_subcommand("lift", "Lift the 2D poses of a single camera to 3D");
  command->add_option("model", arguments->model, "A model file, or the folder of a finished run")->required();
  command->add_option("input", arguments->input, "A dataset, or a detector's files of one camera")->required();
  command->add_option("-o,--output", arguments->output, "Where to write: .npz, .csv, .json, or .h5 for a scene")
      ->required();
  command->add_option("--camera", arguments->camera, "Which camera, if the input holds several");
  command->add_option("--sequence", arguments->sequence, "Which sequence, if the dataset holds several");
  command->add_option("--frames", arguments->frames, "Frames A-B of the dataset only, counted from 0");
  command->add_option("--height", arguments->height_m, "The person's height in metres, for output in millimetres");
  command->add_option(
      "--smooth", arguments->smooth_frames,
      "Smooth a video's poses over this many frames, an odd number such as 9 at 30 frames per second (default: none)");
  command->add_flag(
      "--fill", arguments->fill,
      "Write the network's guess for joints that the view does not show, with confidence 0 (default: NaN)");
  command->add_option("--person", arguments->person, "Whom to follow in a detector's files: 1 is the most prominent")
      ->check(CLI::PositiveNumber);
  command->add_option("--format", arguments->format,
                      "Format of a detector's files (default: recognised by their content)");
  command->add_option("--layout", arguments->layout,
                      "Layout of a detector's files (default: that of the training data)");
  command->add_option("--image-size", arguments->image_size,
                      "Image size, WxH in pixels, for a detector's files and models of preset best (ray=root)");
  command->add_option("--device", arguments->device, "cpu or cuda (default cpu)");
  command->callback([arguments] { RunLift(*arguments); });
}

}  // namespace canonpose
