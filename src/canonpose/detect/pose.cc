#include "canonpose/detect/pose.h"

#include <algorithm>
#include <limits>

namespace canonpose {
namespace {

constexpr std::array<std::size_t, 4> kTrunk{kLShoulder, kRShoulder, kLHip, kRHip};
constexpr int kFewestCommonJoints = 3;

}  // namespace

Eigen::Vector2f CentreOf(const DetectedPose& pose) {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  int count = 0;
  for (const PosePoint& point : pose.joints) {
    if (!IsSeen(point)) continue;
    sum += point.position;
    ++count;
  }
  return count > 0 ? Eigen::Vector2f(sum / static_cast<float>(count)) : sum;
}

float SizeOf(const DetectedPose& pose) {
  float size = 1.0F;
  for (const std::size_t a : kTrunk) {
    for (const std::size_t b : kTrunk) {
      if (!IsSeen(pose.joints[a]) || !IsSeen(pose.joints[b])) continue;
      size = std::max(size, (pose.joints[a].position - pose.joints[b].position).norm());
    }
  }
  Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector2f high = -low;
  for (const PosePoint& point : pose.joints) {
    if (!IsSeen(point)) continue;
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  // A whole body is about three trunks high; less is seen of somebody who bends or whose trunk is hidden.
  constexpr float kTrunksInBody = 3.0F;
  if (low.x() <= high.x()) size = std::max(size, (high - low).norm() / kTrunksInBody);
  return size;
}

int SeenCount(const DetectedPose& pose) {
  return static_cast<int>(std::count_if(pose.joints.begin(), pose.joints.end(), IsSeen));
}

float PoseDistance(const DetectedPose& a, const DetectedPose& b) {
  float sum = 0.0F;
  int count = 0;
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    if (!IsSeen(a.joints[j]) || !IsSeen(b.joints[j])) continue;
    sum += (a.joints[j].position - b.joints[j].position).norm();
    ++count;
  }
  if (count < kFewestCommonJoints) return std::numeric_limits<float>::infinity();
  return sum / static_cast<float>(count) / SizeOf(a);
}

}  // namespace canonpose
