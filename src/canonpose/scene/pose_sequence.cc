#include "canonpose/scene/pose_sequence.h"

#include <cmath>
#include <limits>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/base/rows.h"

namespace canonpose {
namespace {
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

std::string ToString(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMillimetres:
      return "mm";
    case LengthUnit::kBodyLengths:
      return "body lengths";
    case LengthUnit::kEachItsOwn:
      return "each pose its own";
  }
  CANONPOSE_CHECK(false, "unit {}", static_cast<int>(unit));
  return "";
}

PoseSequence::PoseSequence(Skeleton skeleton, int frame_count)
    : skeleton_(std::move(skeleton)), frame_count_(frame_count) {
  CANONPOSE_CHECK(frame_count >= 0, "{}", frame_count);
  const std::size_t joints = static_cast<std::size_t>(frame_count) * skeleton_.joints.size();
  positions_.assign(3 * joints, kNaN);
  confidence_.assign(joints, 0.0F);
  standard_deviation_.assign(joints, kNaN);
}

PoseSequence::PoseSequence(Skeleton skeleton, std::vector<float> positions) : skeleton_(std::move(skeleton)) {
  const std::size_t row = 3 * skeleton_.joints.size();
  CANONPOSE_CHECK(row > 0 && positions.size() % row == 0, "{} values for {} joints", positions.size(),
                  skeleton_.joints.size());
  frame_count_ = static_cast<int>(positions.size() / row);
  positions_ = std::move(positions);
  confidence_.resize(positions_.size() / 3);
  standard_deviation_.assign(confidence_.size(), kNaN);
  TrustKnownJoints();
}

bool PoseSequence::AnyKnown() const {
  for (int frame = 0; frame < frame_count_; ++frame) {
    for (int joint = 0; joint < joint_count(); ++joint) {
      if (IsKnown(frame, joint)) return true;
    }
  }
  return false;
}

void PoseSequence::TrustKnownJoints() {
  for (std::size_t i = 0; i < confidence_.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3f> position(&positions_[3 * i]);
    confidence_[i] = position.allFinite() ? 1.0F : 0.0F;
  }
}

void PoseSequence::KeepFrames(int first, int last, int step) {
  CANONPOSE_CHECK(first >= 0 && step > 0, "{} {}", first, step);
  const int end = last < frame_count_ ? last + 1 : frame_count_;
  KeepRows(positions_, frame_count_, first, end, step);
  KeepRows(confidence_, frame_count_, first, end, step);
  KeepRows(standard_deviation_, frame_count_, first, end, step);
  KeepRows(time_seconds, frame_count_, first, end, step);
  fps /= step;
  frame_count_ = first < end ? (end - 1 - first) / step + 1 : 0;
}

double PoseSequence::TimeOf(int frame) const {
  if (!time_seconds.empty()) return time_seconds[static_cast<std::size_t>(frame)];
  return fps > 0.0 ? frame / fps : frame;
}

PoseSequence PosesInCamera(const Skeleton& skeleton, std::vector<float> positions, LengthUnit unit,
                           const std::string& camera) {
  if (positions.empty()) return {};
  PoseSequence poses(skeleton, std::move(positions));
  poses.unit = unit;
  poses.coordinate_frame = {CoordinateFrame::Kind::kCamera, camera};
  return poses;
}

PoseSequence PosesAboutRoot(const Skeleton& skeleton, std::vector<float> positions, const std::string& camera) {
  PoseSequence poses = PosesInCamera(skeleton, std::move(positions), LengthUnit::kEachItsOwn, camera);
  poses.coordinate_frame.kind = CoordinateFrame::Kind::kRoot;
  return poses;
}

}  // namespace canonpose
