// canonpose simulate [MOTION...] -o data.h5
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/data/dataset.h"
#include "canonpose/export/bvh.h"
#include "canonpose/export/keypoint_files.h"
#include "canonpose/geometry/normalisation.h"
#include "canonpose/simulate/simulator.h"
#include "canonpose/simulate/statistics.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  SimulationOptions options;
  fs::path output;
  fs::path openpose;
  fs::path alphapose;
  fs::path bvh;
  std::vector<std::string> activities;
  bool describe = false;
  int threads = 0;
};

/// What is written beside the dataset: the clips as files of other programs, in folders that appear when all is done.
class OtherFormats {
 public:
  explicit OtherFormats(const SimulateArguments& arguments) {
    if (!arguments.openpose.empty()) openpose_.emplace(arguments.openpose);
    if (!arguments.alphapose.empty()) alphapose_.emplace(arguments.alphapose);
    if (!arguments.bvh.empty()) bvh_.emplace(arguments.bvh);
  }

  void Write(const SimulatedClip& clip, int joint_count) const {
    for (std::size_t c = 0; c < clip.cameras.size(); ++c) {
      CameraView detected;
      detected.name = clip.cameras[c].name;
      detected.keypoints = clip.detections[c].keypoints;
      detected.confidence = clip.detections[c].confidence;
      if (openpose_) {
        WriteOpenPose(openpose_->temporary_path() / clip.sequence.name / detected.name, detected, joint_count);
      }
      if (alphapose_) {
        const fs::path folder = alphapose_->temporary_path() / clip.sequence.name;
        WriteAlphaPose(folder / fmt::format("{}.json", detected.name), detected, joint_count);
      }
    }
    if (bvh_) WriteBvh(bvh_->temporary_path() / fmt::format("{}.bvh", clip.motion.name), clip.motion);
  }

  void Commit() {
    for (std::optional<AtomicFolder>* folder : {&openpose_, &alphapose_, &bvh_}) {
      if (*folder) (*folder)->Commit();
    }
  }

 private:
  std::optional<AtomicFolder> openpose_;
  std::optional<AtomicFolder> alphapose_;
  std::optional<AtomicFolder> bvh_;
};

/// Warns of clips that the cameras hardly see: training learns from frames that two cameras share.
class VisibilityCheck {
 public:
  explicit VisibilityCheck(const Skeleton& skeleton) : joint_count_(skeleton.joint_count()), root_(skeleton.root) {}

  void Add(const Sequence& sequence) {
    int shared = 0;
    for (int t = 0; t < sequence.frame_count; ++t) {
      int seeing = 0;
      for (const CameraView& view : sequence.cameras) seeing += IsUsable(view, t) ? 1 : 0;
      shared += seeing >= 2 ? 1 : 0;
    }
    any_ = any_ || shared > 0;
    ++clips_;
    if (2 * shared < sequence.frame_count) ++hidden_;
  }
  /// Throws Error(kComputation) where nothing is seen at all.
  void Report() const {
    constexpr const char* kAdvice =
        "for people who move far use --rig ptz or handheld, which follow them; cameras of a rig file must look at the "
        "origin";
    if (!any_) ThrowComputation("no frame of any clip is seen by two cameras; {}", kAdvice);
    if (hidden_ > 0) {
      LogWarning("{} of {} clips are seen by two cameras in less than half of their frames; {}", hidden_, clips_,
                 kAdvice);
    }
  }

 private:
  /// As training takes it.
  bool IsUsable(const CameraView& view, int frame) {
    const std::size_t first = static_cast<std::size_t>(frame) * static_cast<std::size_t>(joint_count_);
    return NormalisePose(&view.keypoints[2 * first], &view.confidence[first], joint_count_, root_, pose_);
  }

  int joint_count_;
  int root_;
  NormalisedPose pose_;
  bool any_ = false;
  int clips_ = 0;
  int hidden_ = 0;
};

SimulationOptions ResolveOptions(const SimulateArguments& arguments) {
  SimulationOptions options = arguments.options;
  if (options.layout.empty() && (!arguments.openpose.empty() || !arguments.alphapose.empty())) {
    options.layout = "body_25b";
    LogInfo("the detector's layout is body_25b (--layout chooses another)");
  }
  for (const std::string& name : arguments.activities) options.activities.push_back(ParseActivity(name));
  return options;
}

void RunSimulate(const SimulateArguments& arguments) {
  if (arguments.output.empty() && !arguments.describe)
    ThrowInvalidArgument("give -o FILE for the dataset, or --describe");
  if (arguments.threads < 0) {
    throw Error(ErrorKind::kBadInput, fmt::format("--threads: expected 0 or more, found {}", arguments.threads));
  }
  if (!arguments.output.empty()) RequireDatasetName(arguments.output);
  const Simulator simulator(ResolveOptions(arguments));
  std::optional<DatasetWriter> writer;
  if (!arguments.output.empty()) writer.emplace(arguments.output, simulator.skeleton(), simulator.source());
  OtherFormats other_formats(arguments);
  DetectorStatistics statistics(simulator.layout());
  VisibilityCheck visibility(simulator.skeleton());

  const StopOnSignal stop_on_signal;
  Progress progress("clip", simulator.clip_count());
  ClipStream clips(simulator, arguments.threads);
  long frames = 0;
  long done = 0;
  while (const std::optional<SimulatedClip> clip = clips.Next()) {
    if (writer) writer->Add(clip->sequence);
    other_formats.Write(*clip, simulator.layout_skeleton().joint_count());
    visibility.Add(clip->sequence);
    for (std::size_t c = 0; arguments.describe && c < clip->cameras.size(); ++c) {
      statistics.Add(clip->track, clip->cameras[c], clip->detections[c]);
    }
    frames += clip->sequence.frame_count;
    progress.Update(++done, clip->sequence.name);
    if (StopRequested()) {
      LogInfo("stopped; nothing was written");
      throw CLI::RuntimeError(StopOnSignal::exit_code());
    }
  }
  visibility.Report();
  other_formats.Commit();
  if (writer) {
    writer->Commit();
    LogInfo("{}: {} clips, {} frames", arguments.output.string(), simulator.clip_count(), frames);
  }
  if (arguments.describe) fmt::print("{}", statistics.Describe());
}

void AddMotionOptions(CLI::App& command, SimulateArguments& arguments) {
  SimulationOptions& options = arguments.options;
  command.add_option("motion", options.motion_files,
                     "Motion capture: .amc (with its .asf beside it) and .bvh files, or folders of them. Without any, "
                     "people and motion are generated");
  command.add_option("--subjects", options.subjects, "Number of generated people (default 4)");
  command.add_option("--clips", options.clips, "Clips of each person (default: one per activity)");
  command.add_option("--people", options.people,
                     "How many of them are filmed together, by the same cameras at the same time (default 1)");
  command.add_option("--seconds", options.seconds, "Length of each clip (default 10)");
  command
      .add_option("--activities", arguments.activities,
                  "What they do in turn: gait, run, jump, squat, sit, reach, throw, gesture, dance, ski (default: all "
                  "but ski)")
      ->delimiter(',');
  command.add_option("--fps", options.fps,
                     "Frames per second (default 50, or a file's own rate, which can only be reduced)");
}

void AddRigOptions(CLI::App& command, RigOptions& rig) {
  command.add_option("--rig", rig.kind,
                     "studio: 4 static cameras; ring: 8 to 14 all around; ptz: 6 that pan, tilt and zoom from afar; "
                     "handheld: 4; or a JSON file (default studio)");
  command.add_option("--cameras", rig.cameras, "Number of cameras (default: the rig's own)");
  command.add_option("--spread", rig.spread,
                     "How cameras stand around the person: even, opposite, quarter or clustered (default even)");
  command.add_option("--distance", rig.distance_m, "Distance from the person in metres (default: the rig's own)");
  command.add_option("--distortion", rig.distortion,
                     "Distortion of the lenses: 0 none, 1 that of a usual sports camera (default 0)");
}

void AddDetectorOptions(CLI::App& command, SimulateArguments& arguments) {
  DetectorOptions& detector = arguments.options.detector;
  command.add_option("--noise", detector.noise,
                     "Scale of all the detector's errors: 0 exact, 1 a modern detector (default 1)");
  command.add_option("--joint-offset", detector.joint_offset,
                     "Systematic offset of the detector's joints: 0 none, 1 usual (default 0)");
  command.add_option("--sync-jitter", detector.sync_jitter,
                     "Synchronisation error of the cameras, in frames (default 0)");
  const auto part = [&](const char* option, double& strength, const char* what) {
    command.add_option(option, strength, fmt::format("{}: 1 usual, 0 none (default 1)", what));
  };
  part("--jitter", detector.jitter, "Noise of every joint");
  part("--occlusion", detector.occlusion, "Errors of joints that the body hides");
  part("--swaps", detector.swaps, "Left and right exchanged");
  part("--outliers", detector.outliers, "Joints found on a wrong limb or in the background");
  part("--missed-joints", detector.missed_joints, "Joints not found");
  part("--missed-frames", detector.missed_frames, "Frames without the person");
  part("--confidence", detector.confidence, "Noise of confidences: with more of it they reveal errors less");
  command.add_option("--skeleton", arguments.options.skeleton, "Skeleton of the dataset (default h36m-17)");
  command.add_option(
      "--layout", arguments.options.layout,
      "The detector's keypoints, mapped onto the skeleton as import does: joints that it lacks, and their truth, are "
      "means of others (default: the skeleton's own joints)");
}

}  // namespace

void AddSimulateCommand(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Make a dataset with known truth: motion, virtual cameras and a detector's errors");
  command->add_option("-o,--output", arguments->output, "Where to write the dataset");
  AddMotionOptions(*command, *arguments);
  AddRigOptions(*command, arguments->options.rig);
  AddDetectorOptions(*command, *arguments);
  command->add_option("--openpose", arguments->openpose,
                      "Folder for the same keypoints in OpenPose's format: CLIP/CAMERA/*.json");
  command->add_option("--alphapose", arguments->alphapose,
                      "Folder for the same keypoints in AlphaPose's format: CLIP/CAMERA.json");
  command->add_option("--bvh", arguments->bvh, "Folder for the motion as BVH files");
  command->add_flag("--describe", arguments->describe, "Print statistics of the detector's errors");
  command->add_option("--detector-seed", arguments->options.detector_seed,
                      "Seed of the systematic offset, for the same detector in several captures (default: --seed)");
  command->add_option("--threads", arguments->threads, "Number of threads (default: all cores)");
  command
      ->add_option("--seed", arguments->options.seed,
                   "Seed of people, motion, cameras and errors; another seed gives another capture (default 0)")
      ->check([](const std::string& text) {
        return text.starts_with('-') ? fmt::format("expected 0 or more, found {}", text) : std::string();
      });
  command->callback([arguments, command] {
    // Refuse options that would be ignored.
    for (const char* option : {"--subjects", "--clips", "--people", "--seconds", "--activities"}) {
      if (!arguments->options.motion_files.empty() && command->count(option) > 0) {
        ThrowInvalidArgument("{} is for generated people; leave it out with motion capture files", option);
      }
    }
    RunSimulate(*arguments);
  });
}

}  // namespace canonpose
