#include "canonpose/train/data_checks.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/data/choice.h"
#include "canonpose/data/duplicates.h"

namespace canonpose {
namespace {

/// Fewer frames than this hold no movement, and statistics over them are undefined.
constexpr std::size_t kFewestFrames = 5;

void AddValues(Fingerprint& fingerprint, const std::vector<float>& values) {
  fingerprint.Add(values.data(), values.size() * sizeof(float));
}

void AddCameras(Fingerprint& fingerprint, const std::vector<Camera>& cameras) {
  for (const Camera& camera : cameras) {
    fingerprint.Add(camera.K.data(), sizeof(double) * 9);
    fingerprint.Add(camera.camera_from_world_rotation.data(), sizeof(double) * 9);
    fingerprint.Add(camera.camera_from_world_translation.data(), sizeof(double) * 3);
    fingerprint.Add(camera.distortion.data(), sizeof(double) * 4);
    // The fifth coefficient was added later: without it the hash is the one in earlier checkpoints.
    if (camera.distortion[4] != 0.0) fingerprint.Add(&camera.distortion[4], sizeof(double));
  }
}

/// Whether the predicate holds for any view of the datasets.
template <typename Predicate>
bool AnyView(const TrainJob& job, Predicate predicate) {
  return std::any_of(job.datasets.begin(), job.datasets.end(), [&](const Dataset& dataset) {
    return std::any_of(dataset.sequences.begin(), dataset.sequences.end(), [&](const Sequence& sequence) {
      return std::any_of(sequence.cameras.begin(), sequence.cameras.end(), predicate);
    });
  });
}

[[noreturn]] void ThrowTooFewFrames(const TrainJob& job, std::size_t frames, int left_out) {
  ThrowBadInput(
      {fmt::format("{}", fmt::join(job.data_files, ", ")), "",
       fmt::format("at least {} frames to train on", kFewestFrames),
       left_out > 0 ? fmt::format("{}, and {} that too few cameras see", frames, left_out) : fmt::format("{}", frames),
       "record more: a minute of varied movement is a good start"});
}

/// Learning from other views needs some.
void RequireViews(const TrainJob& job) {
  if (std::ranges::any_of(job.datasets, [](const Dataset& dataset) {
        return std::ranges::any_of(dataset.sequences, [](const Sequence& one) { return one.cameras.size() >= 2; });
      })) {
    return;
  }
  for (std::size_t i = 0; i < job.datasets.size(); ++i) RequireTwoCameras(job.datasets[i], job.data_files[i]);
}

void RequireTarget(const TrainJob& job) {
  const TrainingTarget target = TargetOf(job.options.supervision);
  if (target == TrainingTarget::kViews) return;
  const bool is_solved = target == TrainingTarget::kSolved;
  const std::string files = fmt::format("{}", fmt::join(job.data_files, ", "));
  const bool has_target = std::any_of(job.datasets.begin(), job.datasets.end(), [&](const Dataset& data) {
    return is_solved ? data.HasSolved() : data.HasTruth();
  });
  if (!has_target && job.options.supervision == Supervision::kTriangulated) {
    ThrowBadInput({files, "", "frames that two calibrated cameras see, which `supervision=triangulated` learns from",
                   "none", "import the data with `calibration`, or train with another preset"});
  }
  if (!has_target && is_solved) {
    ThrowBadInput(
        {files, "", "solved 3D poses, which `supervision=solved` learns from", "none", "run `canonpose solve` first"});
  }
  if (!has_target) {
    ThrowBadInput({files, "", "truth, which `supervision=truth` learns from", "none",
                   "simulate a capture, or train with another preset"});
  }
  if (job.options.new_views > 0.0 && !AnyView(job, [&](const CameraView& view) {
        return !TargetPoses(view, target).empty() && !TargetCameras(view, target).empty();
      })) {
    ThrowBadInput({files, "",
                   fmt::format("{} cameras, which `new_views` are made with", is_solved ? "solved" : "calibrated"),
                   "none", "train with `new_views=0`"});
  }
}

}  // namespace

std::string FingerprintOf(const Dataset& dataset, const TrainOptions& options) {
  std::string text = fmt::format("{:016x}", dataset.Fingerprint());
  const TrainingTarget target = TargetOf(options.supervision);
  const bool sees_known_cameras = options.ray != RayForm::kOff && options.focal == FocalSource::kKnown;
  if (target == TrainingTarget::kViews && !sees_known_cameras) return text;
  Fingerprint fingerprint;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) {
      if (target != TrainingTarget::kViews) AddValues(fingerprint, TargetPoses(view, target).positions());
      if (target == TrainingTarget::kSolved && !LacksUncertainty(view.solved)) {
        AddValues(fingerprint, view.solved.standard_deviation());
      }
      if (options.new_views > 0.0) AddCameras(fingerprint, TargetCameras(view, target));
      if (!sees_known_cameras) continue;
      AddCameras(fingerprint, view.solved_calibration);
      AddCameras(fingerprint, view.calibration);
    }
  }
  return fmt::format("{}-{:016x}", text, fingerprint.value());
}

void RequireSuitableData(const TrainJob& job) {
  for (std::size_t i = 1; i < job.datasets.size(); ++i) {
    if (job.datasets[i].skeleton.SameJoints(job.datasets[0].skeleton)) continue;
    ThrowBadInput({job.data_files[i], "/skeleton", fmt::format("the joints of {}", job.data_files[0]),
                   fmt::format("others ({})", fmt::join(job.datasets[i].skeleton.joints, ", ")),
                   "import all data onto the same skeleton"});
  }
  RequireTarget(job);
  if (TargetOf(job.options.supervision) == TrainingTarget::kViews) RequireViews(job);
  RequireRecordings(job);
}

void RequireRecordings(const TrainJob& job) {
  std::size_t frames = 0;
  for (const Dataset& dataset : job.datasets) {
    for (const Sequence& sequence : dataset.sequences) frames += static_cast<std::size_t>(sequence.frame_count);
  }
  if (frames < kFewestFrames) ThrowTooFewFrames(job, frames, 0);
  RequireDistinctRecordings(job.datasets, job.data_files);
}

void RequireEnoughFrames(const TrainJob& job, const TrainingSplit& split) {
  const std::size_t frames = split.training.frames.size();
  if (frames < kFewestFrames) ThrowTooFewFrames(job, frames, split.frames_left_out);
}

}  // namespace canonpose
