// Poses in millimetres, from a person's height: ScaleToHeight() of pose_lifter.h.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose {
namespace {

struct HeadJoint {
  const char* name;
  double height;
};

/// Joints that the path may end in at the top, best first. A head joint is taken to be the top of the head.
constexpr HeadJoint kHeads[] = {{"HeadTop", 1.0}, {"top_head", 1.0}, {"Head", 1.0}, {"Nose", 0.91}};
constexpr const char* kAnkles[][2] = {{"LFoot", "RFoot"}, {"LAnkle", "RAnkle"}, {"LAnk", "RAnk"}, {"lfoot", "rfoot"}};

double BoneLength(const float* pose, int joint, int parent) {
  double squares = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double difference = static_cast<double>(pose[3 * joint + axis]) - pose[3 * parent + axis];
    squares += difference * difference;
  }
  return std::sqrt(squares);
}

/// Sum of the bones from a joint up to the root of the tree.
double PathToRoot(const float* pose, const Skeleton& skeleton, int joint) {
  double length = 0.0;
  for (int j = joint; skeleton.parents[static_cast<std::size_t>(j)] >= 0;
       j = skeleton.parents[static_cast<std::size_t>(j)]) {
    length += BoneLength(pose, j, skeleton.parents[static_cast<std::size_t>(j)]);
  }
  return length;
}

double SumOfBones(const float* pose, const Skeleton& skeleton) {
  double sum = 0.0;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[static_cast<std::size_t>(j)] >= 0)
      sum += BoneLength(pose, j, skeleton.parents[static_cast<std::size_t>(j)]);
  }
  return sum;
}

}  // namespace

void ScaleToHeight(LiftedPoses& poses, double height_mm) {
  const Skeleton& skeleton = poses.skeleton();
  int head = -1;
  double head_height = 1.0;
  for (const HeadJoint& candidate : kHeads) {
    if (const auto found = skeleton.Find(candidate.name); found && head < 0) {
      head = *found;
      head_height = candidate.height;
    }
  }
  int left = -1;
  int right = -1;
  for (const auto& pair : kAnkles) {
    if (left >= 0) break;
    left = skeleton.Find(pair[0]).value_or(-1);
    right = skeleton.Find(pair[1]).value_or(-1);
  }
  if (head < 0 || left < 0 || right < 0) {
    ThrowBadInput({"`height`", "", "a skeleton with ankles and a head", "a model whose skeleton lacks them",
                   "leave `height` out"});
  }
  const std::size_t stride = skeleton.joints.size() * 3;
  std::vector<double> ratios;  // length of the path from ankle to head / sum of all bones
  for (std::size_t t = 0; t < static_cast<std::size_t>(poses.frame_count()); ++t) {
    const float* pose = &poses.pose_in_camera.positions()[t * stride];
    if (!std::isfinite(pose[0])) continue;
    const double legs = 0.5 * (PathToRoot(pose, skeleton, left) + PathToRoot(pose, skeleton, right));
    ratios.push_back((legs + PathToRoot(pose, skeleton, head)) / SumOfBones(pose, skeleton));
  }
  poses.pose_in_camera.unit = poses.canonical.unit = LengthUnit::kMillimetres;
  if (ratios.empty()) return;
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
  const double sum_of_bones_mm = height_mm * (head_height - kAnkleHeight) / ratios[ratios.size() / 2];
  for (std::size_t t = 0; t < static_cast<std::size_t>(poses.frame_count()); ++t) {
    float* pose = &poses.pose_in_camera.positions()[t * stride];
    if (!std::isfinite(pose[0])) continue;
    const auto scale = static_cast<float>(sum_of_bones_mm / SumOfBones(pose, skeleton));
    for (std::size_t i = 0; i < stride; ++i) {
      pose[i] *= scale;
      poses.canonical.positions()[t * stride + i] *= scale;
    }
  }
}

}  // namespace canonpose
