#include "canonpose/detect/decoding.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

// The graph's constants, as the 16-bit floats that they are stored as.
constexpr float kDistanceOffset = 1.7998046875F;
constexpr float kGaussianWidth = 0.300048828125F;
constexpr float kLeastJointScore = 0.126953125F;
constexpr float kSameValue = 1.0132789611816406e-06F;
constexpr int kPeakRadius = 2;
constexpr std::size_t kMostPeople = 6;

float Sigmoid(float value) { return 1.0F / (1.0F + std::exp(-value)); }

struct Cell {
  int y = 0;
  int x = 0;
};

void RequireSize(const FeatureMap& map, const FeatureMap& first, int channels) {
  CANONPOSE_CHECK(map.height == first.height && map.width == first.width && map.channels == channels,
                  "a map of {}x{}x{} with one of {}x{}", map.height, map.width, map.channels, first.height,
                  first.width);
}

void RequireSizes(const PoseMaps& maps) {
  constexpr int kJoints = static_cast<int>(kPoseJoints);
  RequireSize(maps.heat, maps.heat, kJoints);
  RequireSize(maps.regress, maps.heat, 2 * kJoints);
  RequireSize(maps.centre, maps.heat, 1);
  RequireSize(maps.offset, maps.heat, 2 * kJoints);
}

/// Where a joint of the person centred in `centre` should be: y, x in cells.
std::pair<float, float> Expected(const PoseMaps& maps, Cell centre, std::size_t joint) {
  const float* regress = maps.regress.At(centre.y, centre.x) + 2 * joint;
  return {static_cast<float>(centre.y) + regress[0], static_cast<float>(centre.x) + regress[1]};
}

/// The position in a cell, as a fraction of the input.
Eigen::Vector2f PositionIn(const PoseMaps& maps, Cell cell, std::size_t joint) {
  const float* offset = maps.offset.At(cell.y, cell.x) + 2 * joint;
  return {(static_cast<float>(cell.x) + offset[1]) / static_cast<float>(maps.heat.width),
          (static_cast<float>(cell.y) + offset[0]) / static_cast<float>(maps.heat.height)};
}

FeatureMap SigmoidOf(FeatureMap map) {
  std::ranges::transform(map.values, map.values.begin(), Sigmoid);
  return map;
}

PosePoint NearestJoint(const PoseMaps& maps, const FeatureMap& heat, Cell centre, std::size_t joint) {
  const auto [y_expected, x_expected] = Expected(maps, centre, joint);
  Cell best;
  float best_value = -1.0F;
  for (int y = 0; y < heat.height; ++y) {
    const float dy = static_cast<float>(y) - y_expected;
    for (int x = 0; x < heat.width; ++x) {
      const float dx = static_cast<float>(x) - x_expected;
      const float value = heat.At(y, x)[joint] / (std::sqrt(dy * dy + dx * dx) + kDistanceOffset);
      if (value <= best_value) continue;
      best_value = value;
      best = {y, x};
    }
  }
  return {PositionIn(maps, best, joint), heat.At(best.y, best.x)[joint]};
}

/// The cells of a person's box: first and last rows and columns.
struct Box {
  float top, left, bottom, right;
};

Box BoxOf(const PoseMaps& maps, Cell centre) {
  const float* scale = maps.box_scale.At(centre.y, centre.x);
  const float* offset = maps.box_offset.At(centre.y, centre.x);
  const float y = static_cast<float>(centre.y) + offset[0];
  const float x = static_cast<float>(centre.x) + offset[1];
  // Weights that are damaged, though of the right number, give anything.
  if (!std::isfinite(y + x + scale[0] + scale[1])) return {0.0F, 0.0F, 0.0F, 0.0F};
  const float half_height = std::max(scale[0], 0.0F) * 0.5F;
  const float half_width = std::max(scale[1], 0.0F) * 0.5F;
  const auto height = static_cast<float>(maps.heat.height);
  const auto width = static_cast<float>(maps.heat.width);
  return {std::clamp(y - half_height, 0.0F, height), std::clamp(x - half_width, 0.0F, width),
          std::clamp(y + half_height, 0.0F, height), std::clamp(x + half_width, 0.0F, width)};
}

/// exp(-(i - expected)² / width) of the rows or columns i.
std::vector<float> Gaussian(int count, float expected, float width) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i) {
    const float d = static_cast<float>(i) - expected;
    values.push_back(std::exp(-d * d / width));
  }
  return values;
}

PosePoint JointInBox(const PoseMaps& maps, const FeatureMap& heat, Cell centre, const Box& box, std::size_t joint) {
  const auto [y_expected, x_expected] = Expected(maps, centre, joint);
  const float width = kGaussianWidth * static_cast<float>(std::min(heat.height, heat.width));
  const std::vector<float> rows = Gaussian(heat.height, y_expected, width);
  const std::vector<float> columns = Gaussian(heat.width, x_expected, width);
  Cell best;
  float best_value = 0.0F;
  for (int y = static_cast<int>(std::ceil(box.top)); static_cast<float>(y) < box.bottom; ++y) {
    for (int x = static_cast<int>(std::ceil(box.left)); static_cast<float>(x) < box.right; ++x) {
      const float value =
          heat.At(y, x)[joint] * rows[static_cast<std::size_t>(y)] * columns[static_cast<std::size_t>(x)];
      if (value <= best_value) continue;
      best_value = value;
      best = {y, x};
    }
  }
  return {PositionIn(maps, best, joint), best_value};
}

/// Cells whose value is the largest within 5x5, the largest first.
std::vector<Cell> Peaks(const FeatureMap& centre, float least_score) {
  std::vector<Cell> peaks;
  for (int y = 0; y < centre.height; ++y) {
    for (int x = 0; x < centre.width; ++x) {
      const float value = *centre.At(y, x);
      if (value < least_score) continue;
      bool is_peak = true;
      for (int v = std::max(0, y - kPeakRadius); v <= std::min(centre.height - 1, y + kPeakRadius); ++v) {
        for (int u = std::max(0, x - kPeakRadius); u <= std::min(centre.width - 1, x + kPeakRadius); ++u) {
          is_peak = is_peak && *centre.At(v, u) - value < kSameValue;
        }
      }
      if (is_peak) peaks.push_back({y, x});
    }
  }
  std::ranges::stable_sort(peaks, [&](Cell a, Cell b) { return *centre.At(a.y, a.x) > *centre.At(b.y, b.x); });
  if (peaks.size() > kMostPeople) peaks.resize(kMostPeople);
  return peaks;
}

}  // namespace

DetectedPose DecodeSinglePose(const PoseMaps& maps, const std::vector<float>& centre_weight) {
  RequireSizes(maps);
  CANONPOSE_CHECK(centre_weight.size() == maps.centre.values.size(), "{} weights", centre_weight.size());
  std::size_t best = 0;
  float best_value = -1.0F;
  for (std::size_t i = 0; i < centre_weight.size(); ++i) {
    const float value = Sigmoid(maps.centre.values[i]) * centre_weight[i];
    if (value <= best_value) continue;
    best_value = value;
    best = i;
  }
  const auto width = static_cast<std::size_t>(maps.centre.width);
  const Cell centre{static_cast<int>(best / width), static_cast<int>(best % width)};
  const FeatureMap heat = SigmoidOf(maps.heat);
  DetectedPose pose;
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    pose.joints[j] = NearestJoint(maps, heat, centre, j);
    pose.score += pose.joints[j].score / static_cast<float>(kPoseJoints);
  }
  return pose;
}

std::vector<DetectedPose> DecodePoses(const PoseMaps& maps, float least_score) {
  RequireSizes(maps);
  RequireSize(maps.box_scale, maps.heat, 2);
  RequireSize(maps.box_offset, maps.heat, 2);
  const FeatureMap heat = SigmoidOf(maps.heat);
  const FeatureMap centres = SigmoidOf(maps.centre);
  std::vector<DetectedPose> poses;
  for (const Cell centre : Peaks(centres, least_score)) {
    const Box box = BoxOf(maps, centre);
    DetectedPose pose;
    float sum = 0.0F;
    int count = 0;
    for (std::size_t j = 0; j < kPoseJoints; ++j) {
      pose.joints[j] = JointInBox(maps, heat, centre, box, j);
      if (pose.joints[j].score <= kLeastJointScore) continue;
      sum += pose.joints[j].score;
      ++count;
    }
    pose.score = *centres.At(centre.y, centre.x) * sum / static_cast<float>(std::max(count, 1));
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace canonpose
