#include "canonpose/evaluate/canonical.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/skeleton/mapping.h"

namespace canonpose {

void CanonicalSpread::Moments::Add(const double* position) {
  for (int axis = 0; axis < 3; ++axis) {
    sum[axis] += position[axis];
    squares += position[axis] * position[axis];
  }
  ++count;
}

double CanonicalSpread::Moments::Deviation() const {
  if (count == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(count);
  const double mean_squared = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (n * n);
  return std::sqrt(std::max(0.0, squares / n - mean_squared));
}

CanonicalSpread::CanonicalSpread(Skeleton skeleton)
    : skeleton_(std::move(skeleton)),
      of_poses_(skeleton_.joints.size()),
      of_frame_(skeleton_.joints.size()),
      of_frames_(skeleton_.joints.size()),
      views_mm_(skeleton_.joints.size(), 0.0) {}

void CanonicalSpread::AddView(const float* canonical, const PoseErrors& errors) {
  if (errors.outcome != PoseOutcome::kEvaluated) return;
  if (!(errors.scale > 0.0)) {
    ++left_out_;
    return;
  }
  ++poses_;
  const float* root = canonical + 3 * skeleton_.root;
  for (std::size_t j = 0; j < of_frame_.size(); ++j) {
    double position_mm[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position_mm[axis] = errors.scale * (static_cast<double>(canonical[3 * j + axis]) - root[axis]);
    }
    of_poses_[j].Add(position_mm);
    of_frame_[j].Add(position_mm);
  }
}

void CanonicalSpread::EndFrame() {
  if (of_frame_.front().count == 0) return;
  if (of_frame_.front().count > 1) ++frames_in_views_;
  for (std::size_t j = 0; j < of_frame_.size(); ++j) {
    Moments& frame = of_frame_[j];
    const auto count = static_cast<double>(frame.count);
    if (frame.count > 1) views_mm_[j] += frame.Deviation();
    const double mean_mm[3] = {frame.sum[0] / count, frame.sum[1] / count, frame.sum[2] / count};
    of_frames_[j].Add(mean_mm);
    frame = Moments();
  }
}

std::optional<CanonicalReport> CanonicalSpread::Finish() const {
  if (poses_ == 0) return std::nullopt;
  CanonicalReport report;
  report.poses = poses_;
  report.left_out = left_out_;
  const double frames =
      frames_in_views_ > 0 ? static_cast<double>(frames_in_views_) : std::numeric_limits<double>::quiet_NaN();
  const auto joints = static_cast<double>(of_poses_.size());
  for (std::size_t j = 0; j < of_poses_.size(); ++j) {
    const CanonicalDeviations joint{of_poses_[j].Deviation(), views_mm_[j] / frames, of_frames_[j].Deviation()};
    report.per_joint.emplace_back(skeleton_.joints[j], joint);
    report.all.std_mm += joint.std_mm / joints;
    report.all.views_mm += joint.views_mm / joints;
    report.all.frames_mm += joint.frames_mm / joints;
  }
  const std::optional<int> right = FindPart(skeleton_, "rhip");
  const std::optional<int> left = FindPart(skeleton_, "lhip");
  if (right && left) {
    report.right_hip_std_mm = report.per_joint[static_cast<std::size_t>(*right)].second.std_mm;
    report.left_hip_std_mm = report.per_joint[static_cast<std::size_t>(*left)].second.std_mm;
  }
  return report;
}

}  // namespace canonpose
