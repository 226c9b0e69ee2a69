#include "canonpose/scene/pose_sequence.h"

#include <cmath>
#include <limits>
#include <utility>

#include "canonpose/base/error.h"

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
  for (std::size_t i = 0; i < confidence_.size(); ++i) confidence_[i] = std::isnan(positions_[3 * i]) ? 0.0F : 1.0F;
  standard_deviation_.assign(confidence_.size(), kNaN);
}

double PoseSequence::TimeOf(int frame) const {
  if (!time_seconds.empty()) return time_seconds[static_cast<std::size_t>(frame)];
  return fps > 0.0 ? frame / fps : frame;
}

}  // namespace canonpose
