#include "canonpose/train/training_set.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "canonpose/base/error.h"
#include "canonpose/geometry/normalisation.h"

namespace canonpose {
namespace {

/// Clips are long enough that the residuals of neighbours are nearly independent; of a short recording, a share that
/// gives several.
constexpr int kLongestClip = 25;
constexpr int kShortestClip = 5;
constexpr int kClipsWanted = 8;

/// Frames are held out at the end of every stretch of this length: spread over the recording, yet not next to every
/// training frame.
constexpr int kValidationStretch = 50;

constexpr double kUnknownFramesPerSecond = 30.0;

bool IsHeldOut(int frame, int frame_count, double share) {
  const int first = frame / kValidationStretch * kValidationStretch;
  const int length = std::min(kValidationStretch, frame_count - first);
  return frame - first >= length - static_cast<int>(std::floor(share * length));
}

/// Numbers names in the order in which they come.
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
  Builder(TrainingSplit& split, int root, int clip_frames, TrainingTarget target)
      : split_(split), root_(root), clip_frames_(clip_frames), target_(target) {}

  void Add(const Sequence& sequence, const std::string& dataset_key, double validation_share) {
    const int capture = captures_((sequence.capture_is_named ? "" : dataset_key) + "/" + sequence.capture);
    Numbering& cameras = cameras_[capture];
    split_.training.static_captures.resize(std::max<std::size_t>(split_.training.static_captures.size(), capture + 1),
                                           1);
    if (!sequence.static_cameras) split_.training.static_captures[static_cast<std::size_t>(capture)] = 0;
    const double fps = sequence.fps > 0.0 ? sequence.fps : kUnknownFramesPerSecond;
    for (int t = 0; t < sequence.frame_count; ++t) {
      TrainingSet& set = IsHeldOut(t, sequence.frame_count, validation_share) ? split_.validation : split_.training;
      AddFrame(sequence, t, {capture, clip_base_ + t / clip_frames_, {}, sequence_number_, t / fps}, cameras, set);
    }
    ++sequence_number_;
    clip_base_ += sequence.frame_count / clip_frames_ + 1;
  }

 private:
  void AddFrame(const Sequence& sequence, int t, TrainingFrame frame, Numbering& cameras, TrainingSet& set) {
    const int joints = set.joint_count;
    const std::size_t first_row = set.confidence.size() / static_cast<std::size_t>(joints);
    const bool with_truth = target_ == TrainingTarget::kTruth;
    for (const CameraView& view : sequence.cameras) {
      const std::size_t offset = static_cast<std::size_t>(t) * static_cast<std::size_t>(joints);
      if (!NormalisePose(&view.keypoints[2 * offset], &view.confidence[offset], joints, root_, pose_)) continue;
      if (with_truth && !AddTruth(view, offset, set)) continue;
      frame.views.push_back({cameras(view.name), static_cast<int>(first_row + frame.views.size())});
      set.keypoints.insert(set.keypoints.end(), pose_.keypoints.begin(), pose_.keypoints.end());
      set.confidence.insert(set.confidence.end(), pose_.confidence.begin(), pose_.confidence.end());
    }
    if (frame.views.size() >= (with_truth ? 1U : 2U)) {
      set.frames.push_back(std::move(frame));
      return;
    }
    // One view has no other to be consistent with.
    set.keypoints.resize(first_row * 2 * static_cast<std::size_t>(joints));
    set.confidence.resize(first_row * static_cast<std::size_t>(joints));
    ++split_.frames_left_out;
  }

  /// Appends the truth of a view; false where too little of it is known.
  bool AddTruth(const CameraView& view, std::size_t offset, TrainingSet& set) const {
    if (view.truth.empty()) return false;
    const auto joints = static_cast<std::size_t>(set.joint_count);
    const float* truth = &view.truth[3 * offset];
    const float* root = &truth[3 * root_];
    double squares = 0.0;
    std::size_t known = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      if (!std::isfinite(truth[3 * j])) continue;
      ++known;
      for (std::size_t c = 0; c < 3; ++c) squares += std::pow(truth[3 * j + c] - root[c], 2);
    }
    if (!std::isfinite(root[0]) || 2 * known < joints || !(squares > 0.0)) return false;
    const double norm = std::sqrt(squares);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t j = 0; j < joints; ++j) {
        set.truth.push_back(static_cast<float>((truth[3 * j + c] - root[c]) / norm));
      }
    }
    return true;
  }

  TrainingSplit& split_;
  int root_;
  int clip_frames_;
  TrainingTarget target_;
  int clip_base_ = 0;
  int sequence_number_ = 0;
  Numbering captures_;
  std::map<int, Numbering> cameras_;
  NormalisedPose pose_;
};

}  // namespace

TrainingSplit MakeTrainingSplit(const std::vector<Dataset>& datasets, double validation_share, TrainingTarget target) {
  CANONPOSE_CHECK(!datasets.empty());
  TrainingSplit split;
  const Skeleton& skeleton = datasets.front().skeleton;
  split.training.joint_count = split.validation.joint_count = skeleton.joint_count();
  int frames = 0;
  for (const Dataset& dataset : datasets) {
    for (const Sequence& sequence : dataset.sequences) frames += sequence.frame_count;
  }
  Builder builder(split, skeleton.root, std::clamp(frames / kClipsWanted, kShortestClip, kLongestClip), target);
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    for (const Sequence& sequence : datasets[i].sequences) builder.Add(sequence, std::to_string(i), validation_share);
  }
  split.validation.static_captures = split.training.static_captures;
  if (split.training.frames.empty() && target == TrainingTarget::kTruth) {
    ThrowComputation(
        "no frame has a true 3D pose to learn from: the preset supervised needs datasets with truth; the others do "
        "not");
  }
  if (split.training.frames.empty()) {
    ThrowComputation(
        "no frame is seen by two cameras at once ({} frames are seen by one or none): check that the cameras are "
        "synchronised and "
        "that the hips are detected",
        split.frames_left_out);
  }
  return split;
}

}  // namespace canonpose
