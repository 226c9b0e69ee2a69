// canonpose detect VIDEO... -o FOLDER
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/detect/detect_videos.h"

namespace canonpose {
namespace {

std::string Describe(const DetectedVideo& video) {
  if (video.was_there) return fmt::format("{}: done before", video.folder.string());
  std::string text = fmt::format("{}: {} frames of {}x{} pixels", video.folder.string(), video.frames,
                                 video.image_size[0], video.image_size[1]);
  if (video.fps > 0.0) text += fmt::format(", {:.5g} per second", video.fps);
  if (video.people == 0) return text + "; nobody was found";
  return text + (video.people == 1 ? "; one person" : fmt::format("; {} people", video.people));
}

struct DetectArguments {
  DetectOptions options;
  std::optional<double> fps;
};

void RunDetect(const DetectArguments& arguments) {
  DetectOptions options = arguments.options;
  if (arguments.fps) {
    if (!std::isfinite(*arguments.fps) || *arguments.fps <= 0.0) {
      ThrowInvalidArgument("--fps: expected frames per second, above 0, found {}", *arguments.fps);
    }
    options.image_fps = *arguments.fps;
  }
  const StopOnSignal stop_on_signal;
  const DetectReport report = DetectVideos(options);
  if (report.stopped) {
    LogInfo("stopped and saved; to continue, run the same command again");
    throw CLI::RuntimeError(StopOnSignal::exit_code());
  }
  for (const DetectedVideo& video : report.videos) LogInfo("{}", Describe(video));
  LogInfo("next: canonpose import openpose {} -o data.h5", options.output.string());
}

}  // namespace

void AddDetectCommand(CLI::App& app) {
  auto arguments = std::make_shared<DetectArguments>();
  DetectOptions* const options = &arguments->options;
  CLI::App* command = app.add_subcommand(
      "detect", "Find people's 2D keypoints in videos, as OpenPose's files with the layout coco-17, for import");
  command
      ->add_option(
          "video", options->videos,
          "Videos, folders of videos, folders of images (one camera each), or quoted patterns of either such as "
          "'cam1/*.png'")
      ->required()
      ->type_name("VIDEO");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for the keypoints, which gets a folder per video; killed, the same command goes on")
      ->required()
      ->type_name("FOLDER");
  command
      ->add_option("--model", options->model,
                   "Folder with MoveNet's files (default: where scripts/get-detector puts them)")
      ->type_name("FOLDER");
  command->add_option("--fps", arguments->fps, "Frames per second of folders of images; videos know theirs")
      ->type_name("FPS");
  command
      ->add_option("--search-interval", options->tracker.search_interval,
                   "Frames from one search of the whole image for people to the next, while nobody is lost")
      ->capture_default_str();
  command->add_option("--most-people", options->tracker.most_people, "Follow at most so many people at a time")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Videos at a time, each on one core (default: all cores)");
  command->callback([arguments] { RunDetect(*arguments); });
}

}  // namespace canonpose
