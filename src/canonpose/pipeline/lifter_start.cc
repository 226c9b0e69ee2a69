#include "canonpose/pipeline/lifter_start.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/skeleton/mapping.h"
#include "canonpose/train/starter.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

StartPoses LiftAll(const PoseLifter& lifter, const Dataset& dataset, const std::string& file) {
  lifter.RequireSkeleton(dataset.skeleton, file);
  StartPoses start;
  start.knows_depth_sign = lifter.info().mirror.decision != "undecided";
  for (const Sequence& sequence : dataset.sequences) {
    start.sequences.emplace_back();
    for (const CameraView& view : sequence.cameras) {
      start.sequences.back().push_back(lifter.Lift(view, sequence.frame_count).pose_in_camera);
    }
  }
  return start;
}

/// Poses whose joints are made from others; NaN if the joints that one is made from are missing. Centred on the root of
/// the target.
PoseSequence MapPoses(const LayoutMapping& mapping, const PoseSequence& lifted, const std::string& camera) {
  const std::vector<float>& poses = lifted.positions();
  const int root = mapping.target.root;
  const std::size_t source_joints = mapping.source.joints.size();
  const std::size_t joints = mapping.joints.size();
  const std::size_t frames = poses.size() / (3 * source_joints);
  std::vector<float> mapped(frames * joints * 3, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t t = 0; t < frames; ++t) {
    const float* pose = &poses[t * source_joints * 3];
    float* target = &mapped[t * joints * 3];
    for (std::size_t i = 0; i < 3 * joints; ++i) {
      const std::vector<int>& sources = mapping.joints[i / 3].sources;
      if (sources.empty()) continue;
      float sum = 0.0F;
      for (const int source : sources) sum += pose[3 * static_cast<std::size_t>(source) + i % 3];
      target[i] = sum / static_cast<float>(sources.size());
    }
    std::array<float, 3> origin{};
    std::copy_n(target + 3 * root, 3, origin.begin());
    for (std::size_t i = 0; i < 3 * joints; ++i) target[i] -= origin[i % 3];
  }
  return PosesAboutRoot(mapping.target, std::move(mapped), camera);
}

/// The same view with the joints of the starter, found by name.
CameraView MapView(const LayoutMapping& mapping, const CameraView& view) {
  const std::size_t source_joints = mapping.source.joints.size();
  const std::size_t joints = mapping.joints.size();
  const std::size_t frames = view.confidence.size() / source_joints;
  CameraView mapped;
  mapped.name = view.name;
  mapped.image_size = view.image_size;
  mapped.keypoints.resize(frames * joints * 2);
  mapped.confidence.resize(frames * joints);
  for (std::size_t t = 0; t < frames; ++t) {
    ApplyMapping(mapping, &view.keypoints[2 * t * source_joints], &view.confidence[t * source_joints],
                 &mapped.keypoints[2 * t * joints], &mapped.confidence[t * joints]);
  }
  return mapped;
}

}  // namespace

bool StarterCanStart(const Skeleton& skeleton) { return StarterKnows(skeleton); }

StartPoses StartFromModel(const Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  return LiftAll(PoseLifter::Open(options.model, options.device), dataset, file);
}

StartPoses StartFromStarter(const Dataset& dataset, const std::string& device) {
  const PoseLifter starter = PoseLifter::Of(BuiltinStarter(), "the starter", device);
  const LayoutMapping to_starter = MapAvailableJoints(dataset.skeleton, starter.skeleton());
  const LayoutMapping from_starter = MapAvailableJoints(starter.skeleton(), dataset.skeleton);
  StartPoses start;
  for (const Sequence& sequence : dataset.sequences) {
    start.sequences.emplace_back();
    for (const CameraView& view : sequence.cameras) {
      const LiftedPoses lifted = starter.Lift(MapView(to_starter, view), sequence.frame_count);
      start.sequences.back().push_back(MapPoses(from_starter, lifted.pose_in_camera, view.name));
    }
  }
  return start;
}

StartPoses StartFromMethod(const Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  TrainJob job;
  job.datasets = {dataset};
  job.data_files = {file};
  job.options = PresetOptions("plus");
  job.options.seed = options.seed;
  job.options.threads = options.threads;
  job.options.device = options.device;
  job.run_folder = options.run_folder;
  job.resume = true;
  LogInfo("training a lifter on {} itself by the method, to start from", file);
  const TrainReport report = Train(job);
  if (report.stopped) throw Error(ErrorKind::kStopped, "stopped while training the lifter to start from");
  return LiftAll(PoseLifter::Of(report.model, "the lifter to start from", options.device), dataset, file);
}

}  // namespace canonpose
