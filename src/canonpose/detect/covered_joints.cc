#include "canonpose/detect/covered_joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace canonpose {
namespace {

/// In the order of the outline.
constexpr std::array<std::size_t, 4> kTrunkOutline{kLShoulder, kRShoulder, kRHip, kLHip};
/// Clothes and flesh reach beyond the joints by so much of the distance from the middle.
constexpr float kTrunkGrowth = 1.25F;
/// Scores of hidden joints are lower by more than that.
constexpr float kClearScore = 0.1F;

using Outline = std::array<Eigen::Vector2f, 4>;

/// The outline of a person's trunk; nothing where it is not seen.
std::optional<Outline> TrunkOf(const DetectedPose& pose) {
  Outline outline;
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!IsSeen(pose.joints[kTrunkOutline[i]])) return std::nullopt;
    outline[i] = pose.joints[kTrunkOutline[i]].position;
    middle += 0.25F * outline[i];
  }
  for (Eigen::Vector2f& corner : outline) corner = middle + kTrunkGrowth * (corner - middle);
  return outline;
}

/// Whether a point is inside, by the number of edges to its right. Outlines of people in profile may cross themselves.
bool IsInside(const Outline& outline, const Eigen::Vector2f& point) {
  bool is_inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2f& a = outline[i];
    const Eigen::Vector2f& b = outline[(i + 1) % outline.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const float x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

/// How low in the image a person stands; nothing where no ankle is seen.
std::optional<float> FeetOf(const DetectedPose& pose) {
  std::optional<float> lowest;
  for (const std::size_t ankle : {kLAnkle, kRAnkle}) {
    const PosePoint& point = pose.joints[ankle];
    if (IsSeen(point)) lowest = std::max(lowest.value_or(point.position.y()), point.position.y());
  }
  return lowest;
}

float MeanScoreInside(const DetectedPose& pose, const std::optional<Outline>& outline) {
  float sum = 0.0F;
  int count = 0;
  for (const PosePoint& point : pose.joints) {
    if (!outline || !IsInside(*outline, point.position)) continue;
    sum += point.score;
    ++count;
  }
  return count > 0 ? sum / static_cast<float>(count) : 1.0F;  // nothing of it is hidden
}

bool IsInFront(const DetectedPose& a, const DetectedPose& b) {
  const float score_a = MeanScoreInside(a, TrunkOf(b));
  const float score_b = MeanScoreInside(b, TrunkOf(a));
  if (std::abs(score_a - score_b) > kClearScore) return score_a > score_b;
  const std::optional<float> feet_a = FeetOf(a);
  const std::optional<float> feet_b = FeetOf(b);
  return feet_a && feet_b ? *feet_a > *feet_b : score_a > score_b;
}

}  // namespace

void MarkCoveredJoints(std::vector<TrackedPose>& people) {
  const std::vector<TrackedPose> before = people;
  for (std::size_t a = 0; a < people.size(); ++a) {
    for (std::size_t b = 0; b < people.size(); ++b) {
      if (a == b || !IsInFront(before[b].pose, before[a].pose)) continue;
      const std::optional<Outline> trunk = TrunkOf(before[b].pose);
      for (std::size_t j = 0; trunk && j < kPoseJoints; ++j) {
        const PosePoint& point = before[a].pose.joints[j];
        if (IsInside(*trunk, point.position)) people[a].pose.joints[j].score = kCoveredShare * point.score;
      }
    }
  }
}

}  // namespace canonpose
