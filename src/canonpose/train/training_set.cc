#include "canonpose/train/training_set.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/model/pose_input.h"

namespace canonpose {
namespace {

/// Clips are so long that the residuals of neighbouring ones are nearly independent; in a short recording they are
/// shorter, so that there are several.
constexpr int kLongestClip = 25;
constexpr int kShortestClip = 5;
constexpr int kClipsWanted = 8;

/// Frames are held out at the end of every stretch of this length: they are spread over the recording, yet few training
/// frames are next to one.
constexpr int kValidationStretch = 50;

constexpr double kUnknownFramesPerSecond = 30.0;

bool IsHeldOut(int frame, int frame_count, double share) {
  const int first = frame / kValidationStretch * kValidationStretch;
  const int length = std::min(kValidationStretch, frame_count - first);
  return frame - first >= length - static_cast<int>(std::floor(share * length));
}

/// Numbers names in the order of their first appearance.
class Numbering {
 public:
  int operator()(const std::string& name) {
    return numbers_.try_emplace(name, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  std::map<std::string, int> numbers_;
};

class Builder {
 public:
  Builder(TrainingSplit& split, const Skeleton& skeleton, int clip_frames, const RowForm& form)
      : split_(split), root_(skeleton.root), clip_frames_(clip_frames), form_(form), input_(form.input, skeleton) {}

  /// `source` has the numbers of dataset and sequence.
  void Add(const Sequence& sequence, RowSource source, double validation_share) {
    const std::string file_key = sequence.capture_is_named ? "" : fmt::format("{}", source.dataset);
    const int capture = captures_(fmt::format("{}/{}", file_key, sequence.capture));
    Numbering& cameras = cameras_[capture];
    split_.training.static_captures.resize(std::max<std::size_t>(split_.training.static_captures.size(), capture + 1),
                                           1);
    if (!sequence.static_cameras) split_.training.static_captures[static_cast<std::size_t>(capture)] = 0;
    const double fps = sequence.fps > 0.0 ? sequence.fps : kUnknownFramesPerSecond;
    for (int t = 0; t < sequence.frame_count; ++t) {
      TrainingSet& set = IsHeldOut(t, sequence.frame_count, validation_share) ? split_.validation : split_.training;
      source.frame = t;
      AddFrame(sequence, source, {capture, clip_base_ + t / clip_frames_, {}, sequence_number_, t / fps}, cameras, set);
    }
    ++sequence_number_;
    clip_base_ += sequence.frame_count / clip_frames_ + 1;
  }

 private:
  void AddFrame(const Sequence& sequence, RowSource source, TrainingFrame frame, Numbering& cameras, TrainingSet& set) {
    const auto joints = static_cast<std::size_t>(set.joint_count);
    const std::size_t first_row = set.confidence.size() / joints;
    const bool with_target = form_.target != TrainingTarget::kViews;
    for (const CameraView& view : sequence.cameras) {
      if (!input_.Normalise(view, source.frame, pose_, turned_from_camera_)) continue;
      if (with_target && !AddTarget(view, source.frame, set)) continue;
      frame.views.push_back({cameras(view.name), static_cast<int>(first_row + frame.views.size())});
      set.keypoints.insert(set.keypoints.end(), pose_.keypoints.begin(), pose_.keypoints.end());
      set.confidence.insert(set.confidence.end(), pose_.confidence.begin(), pose_.confidence.end());
      source.camera = static_cast<int>(&view - sequence.cameras.data());
      set.sources.push_back(source);
      if (form_.input.ray != RayForm::kOff) set.turned_from_camera.push_back(turned_from_camera_.cast<float>());
    }
    if (frame.views.size() >= (with_target ? 1U : 2U)) {
      set.frames.push_back(std::move(frame));
      return;
    }
    // A single view has no other to be consistent with.
    set.keypoints.resize(first_row * 2 * joints);
    set.confidence.resize(first_row * joints);
    set.sources.resize(first_row);
    if (form_.input.ray != RayForm::kOff) set.turned_from_camera.resize(first_row);
    ++split_.frames_left_out;
  }

  /// Appends the target of a view. False where too little of it is known.
  bool AddTarget(const CameraView& view, int t, TrainingSet& set) {
    const std::vector<float>& poses = TargetPoses(view, form_.target).positions();
    if (poses.empty()) return false;
    const auto joints = static_cast<std::size_t>(set.joint_count);
    const std::size_t offset = static_cast<std::size_t>(t) * joints;
    target_.resize(3 * joints);
    const std::optional<double> norm =
        NormaliseTarget(&poses[3 * offset], set.joint_count, root_, turned_from_camera_, target_.data());
    if (!norm) return false;
    set.target.insert(set.target.end(), target_.begin(), target_.end());
    if (!form_.uncertainty_weights) return true;
    for (std::size_t j = 0; j < joints; ++j) {
      const float uncertainty = form_.target == TrainingTarget::kSolved ? view.solved.standard_deviation()[offset + j]
                                                                        : std::numeric_limits<float>::quiet_NaN();
      set.target_weight.push_back(static_cast<float>(uncertainty / *norm));
    }
    return true;
  }

  TrainingSplit& split_;
  int root_;
  int clip_frames_;
  RowForm form_;
  PoseInput input_;
  int clip_base_ = 0;
  int sequence_number_ = 0;
  Numbering captures_;
  std::map<int, Numbering> cameras_;
  NormalisedPose pose_;
  Eigen::Matrix3d turned_from_camera_;
  std::vector<float> target_;
};

/// Replaces uncertainties, relative to the poses' sizes, by weights. An unknown uncertainty counts as the median.
void MakeWeights(std::vector<float>& uncertainties) {
  std::vector<float> known;
  std::copy_if(uncertainties.begin(), uncertainties.end(), std::back_inserter(known),
               [](float value) { return std::isfinite(value); });
  float median = 0.0F;
  if (!known.empty()) {
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    median = *middle;
  }
  for (float& value : uncertainties) {
    const float ratio = median > 0.0F && std::isfinite(value) ? value / median : 1.0F;
    value = 1.0F / (1.0F + ratio * ratio);
  }
}

std::size_t MostCameras(const std::vector<Dataset>& datasets) {
  std::size_t most = 0;
  for (const Dataset& dataset : datasets) {
    for (const Sequence& sequence : dataset.sequences) most = std::max(most, sequence.cameras.size());
  }
  return most;
}

}  // namespace

TrainingTarget TargetOf(Supervision supervision) {
  if (supervision == Supervision::kNone) return TrainingTarget::kViews;
  return supervision == Supervision::kTruth ? TrainingTarget::kTruth : TrainingTarget::kSolved;
}

const PoseSequence& TargetPoses(const CameraView& view, TrainingTarget target) {
  return target == TrainingTarget::kSolved ? view.solved : view.truth;
}

const std::vector<Camera>& TargetCameras(const CameraView& view, TrainingTarget target) {
  return target == TrainingTarget::kSolved ? view.solved_calibration : view.calibration;
}

std::optional<double> NormaliseTarget(const float* pose, int joint_count, int root,
                                      const Eigen::Matrix3d& turned_from_camera, float* target) {
  const auto joint = [&](int j) { return Eigen::Vector3f(pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]); };
  const Eigen::Vector3f root_in_camera = joint(root);
  double squares = 0.0;
  int known = 0;
  for (int j = 0; j < joint_count; ++j) {
    const Eigen::Vector3d centred = (joint(j) - root_in_camera).cast<double>();
    const Eigen::Vector3d turned = turned_from_camera * centred;
    for (int axis = 0; axis < 3; ++axis) target[axis * joint_count + j] = static_cast<float>(turned[axis]);
    if (!centred.allFinite()) continue;
    ++known;
    for (const double offset : centred) squares += offset * offset;
  }
  if (2 * known < joint_count || !(squares > 0.0)) return std::nullopt;
  const double norm = std::sqrt(squares);
  for (int i = 0; i < 3 * joint_count; ++i) target[i] = static_cast<float>(target[i] / norm);
  return norm;
}

TrainingSplit MakeTrainingSplit(const std::vector<Dataset>& datasets, double validation_share, const RowForm& form) {
  CANONPOSE_CHECK(!datasets.empty());
  TrainingSplit split;
  const Skeleton& skeleton = datasets.front().skeleton;
  split.training.joint_count = split.validation.joint_count = skeleton.joint_count();
  int frames = 0;
  for (const Dataset& dataset : datasets) {
    for (const Sequence& sequence : dataset.sequences) frames += sequence.frame_count;
  }
  Builder builder(split, skeleton, std::clamp(frames / kClipsWanted, kShortestClip, kLongestClip), form);
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    for (std::size_t s = 0; s < datasets[i].sequences.size(); ++s) {
      builder.Add(datasets[i].sequences[s], {static_cast<int>(i), static_cast<int>(s), 0, 0}, validation_share);
    }
  }
  split.validation.static_captures = split.training.static_captures;
  split.validation.target_weight.clear();
  MakeWeights(split.training.target_weight);
  if (split.training.frames.empty() && form.target == TrainingTarget::kTruth) {
    ThrowComputation(
        "no frame has both a 2D pose and a true 3D pose to learn from: check the data, or train with another preset");
  }
  if (split.training.frames.empty() && form.target == TrainingTarget::kSolved) {
    ThrowComputation(
        "no frame has both a 2D pose and a solved 3D pose to learn from: check the report of `canonpose solve`");
  }
  if (split.training.frames.empty() && MostCameras(datasets) < 2) {
    ThrowComputation(
        "all recordings have one camera: learning without labels needs at least two (one is enough to lift with a "
        "trained model)");
  }
  if (split.training.frames.empty()) {
    ThrowComputation(
        "in no frame do two cameras see the person ({} frames are seen by one or none): check that the cameras are "
        "synchronised and that the hips are detected",
        split.frames_left_out);
  }
  return split;
}

}  // namespace canonpose
