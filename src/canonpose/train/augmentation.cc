#include "canonpose/train/augmentation.h"

#include <cmath>
#include <utility>

namespace canonpose {
namespace {

constexpr std::size_t kMaxJointsDropped = 4;

}  // namespace

void FlipRow(const Skeleton& skeleton, const TrainingRow& row) {
  const auto joints = skeleton.joints.size();
  const auto swap_partners = [&](float* values) {
    for (std::size_t j = 0; j < joints; ++j) {
      const auto partner = static_cast<std::size_t>(skeleton.mirror[j]);
      if (j < partner) std::swap(values[j], values[partner]);
    }
  };
  for (std::size_t axis = 0; axis < 2; ++axis) swap_partners(row.keypoints + axis * joints);
  swap_partners(row.confidence);
  for (std::size_t j = 0; j < joints; ++j) row.keypoints[j] = -row.keypoints[j];
  if (row.target != nullptr) {
    for (std::size_t axis = 0; axis < 3; ++axis) swap_partners(row.target + axis * joints);
    for (std::size_t j = 0; j < joints; ++j) row.target[j] = -row.target[j];
  }
  if (row.target_weight != nullptr) swap_partners(row.target_weight);
}

void DropJoints(const Skeleton& skeleton, Rng& rng, const TrainingRow& row) {
  const std::size_t joints = skeleton.joints.size();
  std::vector<std::size_t> seen;
  for (std::size_t j = 0; j < joints; ++j) {
    if (row.confidence[j] > 0.0F && static_cast<int>(j) != skeleton.root) seen.push_back(j);
  }
  std::size_t remaining = seen.size() + 1;
  for (std::size_t wanted = 1 + rng.Index(kMaxJointsDropped); wanted > 0 && 2 * (remaining - 1) >= joints; --wanted) {
    const std::size_t chosen = rng.Index(seen.size());
    const std::size_t joint = seen[chosen];
    seen.erase(seen.begin() + static_cast<std::ptrdiff_t>(chosen));
    row.keypoints[joint] = row.keypoints[joints + joint] = row.confidence[joint] = 0.0F;
    --remaining;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < 2 * joints; ++i) squares += static_cast<double>(row.keypoints[i]) * row.keypoints[i];
  if (!(squares > 0.0)) return;
  const auto scale =
      static_cast<float>(1.0 / std::sqrt(squares * static_cast<double>(joints) / static_cast<double>(remaining)));
  for (std::size_t i = 0; i < 2 * joints; ++i) row.keypoints[i] *= scale;
}

InputForm InputFormOf(const TrainOptions& options) { return {options.ray, options.focal, options.input_confidences}; }

RowForm RowFormOf(const TrainOptions& options) {
  const TrainingTarget target = TargetOf(options.supervision);
  const bool weights = target == TrainingTarget::kSolved && options.uncertainty_weights;
  return {target, InputFormOf(options), weights};
}

Augmentation::Augmentation(const std::vector<Dataset>& datasets, const TrainingSet& set, const TrainOptions& options)
    : skeleton_(datasets.front().skeleton),
      share_of_new_views_(options.new_views),
      flips_(options.flips),
      joint_dropout_(options.joint_dropout) {
  if (share_of_new_views_ > 0.0) new_views_.emplace(datasets, set, RowFormOf(options));
}

void Augmentation::Change(int set_row, Rng& rng, const TrainingRow& row) const {
  if (new_views_ && new_views_->any() && rng.Uniform() < share_of_new_views_) {
    // A view in which too few joints would be visible leaves the row as it is.
    static_cast<void>(new_views_->See(set_row, new_views_->Draw(set_row, rng), row));
  }
  if (flips_ > 0.0 && rng.Uniform() < flips_) FlipRow(skeleton_, row);
  if (joint_dropout_ > 0.0 && rng.Uniform() < joint_dropout_) DropJoints(skeleton_, rng, row);
}

}  // namespace canonpose
