// canonpose lift RUN|model.cpm INPUT -o out.npz
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/import.h"
#include "canonpose/export/lift_output.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/pipeline/lift_views.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct LiftArguments {
  fs::path model;
  fs::path input;
  fs::path output;
  LiftChoice choice;
  std::string image_size;
  LiftOptions options;
  std::string device = "cpu";
};

/// Refuses options that would be ignored.
void RefuseMisplacedOptions(const LiftArguments& arguments, bool is_dataset) {
  const auto refuse = [&](bool given, const char* option) {
    if (given) {
      ThrowInvalidArgument("{} is for {}, and {} is not one", option, is_dataset ? "a detector's files" : "datasets",
                           arguments.input.string());
    }
  };
  refuse(!is_dataset && !arguments.choice.frames.empty(), "--frames");
  refuse(!is_dataset && !arguments.choice.sequence.empty(), "--sequence");
  refuse(is_dataset && !arguments.choice.format.empty(), "--format");
  refuse(is_dataset && !arguments.choice.layout.empty(), "--layout");
  refuse(is_dataset && !arguments.image_size.empty(), "--image-size");
  refuse(is_dataset && arguments.choice.person != 1, "--person");
}

void RunLift(const LiftArguments& arguments) {
  RequireLiftFormat(arguments.output);
  RequireOutputIsNotAnInput(arguments.output, {arguments.model, arguments.input});
  arguments.options.Validate();
  if (!fs::exists(arguments.input)) {
    ThrowBadInput({arguments.input.string(), "", "a dataset or a detector's files", "nothing", "check the path"});
  }
  const bool is_dataset = IsDatasetFile(arguments.input);
  RefuseMisplacedOptions(arguments, is_dataset);
  const PoseLifter lifter = PoseLifter::Open(arguments.model, arguments.device);
  for (const std::string& doubt : DoubtsAbout(lifter.info())) {
    LogWarning("{}: do not rely on these 3D poses: {}", arguments.model.string(), doubt);
  }
  LiftChoice choice = arguments.choice;
  if (!arguments.image_size.empty()) choice.image_size = ParseImageSize(arguments.image_size);
  const LiftInput input = ReadLiftInput(arguments.input, choice, lifter);
  const LiftedPoses lifted = LiftViews(lifter, input, arguments.options, arguments.input.string());
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
                                          arguments.options.fill ? "guesses with confidence 0" : "left empty")
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
  command->add_option("--camera", arguments->choice.camera, "Which camera, if the input holds several");
  command->add_option("--sequence", arguments->choice.sequence, "Which sequence, if the dataset holds several");
  command->add_option("--frames", arguments->choice.frames, "Frames A-B of the dataset only, counted from 0");
  command->add_option("--height", arguments->options.height_m,
                      "The person's height in metres, for output in millimetres");
  command->add_option(
      "--smooth", arguments->options.smooth_frames,
      "Smooth a video's poses over this many frames, an odd number such as 9 at 30 frames per second (default: none)");
  command->add_flag(
      "--fill", arguments->options.fill,
      "Write the network's guess for joints that the view does not show, with confidence 0 (default: NaN)");
  command
      ->add_option("--person", arguments->choice.person,
                   "Whom to follow in a detector's files: 1 is the most prominent")
      ->check(CLI::PositiveNumber);
  command->add_option("--format", arguments->choice.format,
                      "Format of a detector's files (default: recognised by their content)");
  command->add_option("--layout", arguments->choice.layout,
                      "Layout of a detector's files (default: that of the training data)");
  command->add_option("--image-size", arguments->image_size,
                      "Image size, WxH in pixels, for a detector's files and models of preset best (ray=root)");
  command->add_option("--device", arguments->device, "cpu or cuda (default cpu)");
  command->callback([arguments] { RunLift(*arguments); });
}

}  // namespace canonpose
