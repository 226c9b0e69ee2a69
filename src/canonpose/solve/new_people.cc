#include "canonpose/solve/new_people.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace canonpose {
namespace {

/// Of a keypoint that is as far off as not at all, body units: about 20 cm.
constexpr double kFarApart = 0.045;
/// People differ in size by a tenth; two people seen as one have any size.
constexpr double kUsualLogSize = 0.12;
constexpr double kImpossibleLogSize = 0.4;
/// Rays to one point that are more parallel than this do not tell the size.
constexpr double kParallelCosine = 0.94;
/// Start poses that differ by this squared distance differ altogether.
constexpr double kOtherPose = 0.4;
constexpr double kPoseShare = 0.5;
constexpr double kCostLimit = 0.6;
constexpr double kWorstPair = 0.8;
constexpr double kAheadSeconds = 1.0;
constexpr double kBlockSeconds = 0.5;
constexpr int kSamples = 8;
constexpr int kMinSamples = 3;

}  // namespace

NewPeople::NewPeople(const PeopleObservations& people, const CameraRays& rays, double bones)
    : people_(people), rays_(rays), bones_(bones) {}

double NewPeople::CostInFrame(const ViewSighting& a, const ViewSighting& b) const {
  const CaptureObservations& capture = people_.capture;
  const std::array<ViewSighting, 2> both = {a, b};
  const JointPositions joints = rays_.Triangulate(both);
  // The point lies between the two rays, so half of their distance is seen in each view.
  double cost = std::max(rays_.Distance(a, joints, 0.5 * kFarApart), rays_.Distance(b, joints, 0.5 * kFarApart));
  double length = 0.0;
  double usual = 0.0;
  double parallel = 0.0;
  for (int j = 0; j < capture.joint_count(); ++j) {
    const int parent = capture.skeleton.parents[static_cast<std::size_t>(j)];
    const Eigen::Vector3d& joint = joints[static_cast<std::size_t>(j)];
    if (parent < 0 || !joint.allFinite() || !joints[static_cast<std::size_t>(parent)].allFinite()) continue;
    length += (joint - joints[static_cast<std::size_t>(parent)]).norm();
    usual += 1.0;
    parallel += std::abs(rays_.RayCosine(a.view, b.view, joint));
  }
  const double bone_count = capture.joint_count() - 1;
  if (usual >= 0.6 * bone_count && parallel < kParallelCosine * usual) {
    const double log_size = std::abs(std::log(length / usual * bone_count / bones_));
    if (!(log_size < kImpossibleLogSize)) return 2.0;
    cost += 2.0 * std::max(0.0, log_size - kUsualLogSize);
  }
  if (capture.HasStart(a.frame, a.view) && capture.HasStart(b.frame, b.view)) {
    const Eigen::Matrix3d relative = rays_.Rotation(b.view) * rays_.Rotation(a.view).transpose();
    const Points3d turned = capture.StartOf(a.frame, a.view) * relative.transpose();
    const double misfit = (capture.StartOf(b.frame, b.view) - turned).squaredNorm();
    cost += kPoseShare * std::min(2.0, misfit / kOtherPose);
  }
  return cost;
}

double NewPeople::Cost(const LaneSighting& a, const LaneSighting& b, int frame) {
  const Lanes& lanes = people_.lanes;
  const int block = static_cast<int>(frame / (kBlockSeconds * lanes.fps));
  const auto [known, is_new] = costs_.try_emplace({{a.tracklet, b.tracklet}, block}, 2.0);
  if (!is_new) return known->second;
  const int last = std::min(lanes.frame_count - 1, frame + static_cast<int>(kAheadSeconds * lanes.fps));
  std::vector<int> common;
  for (int t = frame; t <= last; ++t) {
    if (lanes.Owner(a.lane, a.view, t) == a.tracklet && lanes.Owner(b.lane, b.view, t) == b.tracklet) {
      common.push_back(t);
    }
  }
  if (static_cast<int>(common.size()) < kMinSamples) return known->second;
  const std::size_t samples = std::min<std::size_t>(kSamples, common.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const int t = common[i * common.size() / samples];
    sum += CostInFrame({a.view, people_.FrameOf(a.lane, t)}, {b.view, people_.FrameOf(b.lane, t)});
  }
  known->second = sum / static_cast<double>(samples);
  return known->second;
}

std::vector<std::vector<LaneSighting>> NewPeople::Find(std::span<const LaneSighting> sightings, int frame) {
  struct Pair {
    double cost;
    std::size_t a;
    std::size_t b;
  };
  const std::size_t count = sightings.size();
  std::vector<std::vector<double>> costs(count, std::vector<double>(count, 2.0));
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (sightings[a].view == sightings[b].view) continue;
      if (!rays_.IsKnown(sightings[a].view) || !rays_.IsKnown(sightings[b].view)) continue;
      costs[a][b] = costs[b][a] = Cost(sightings[a], sightings[b], frame);
      if (costs[a][b] < kCostLimit) pairs.push_back({costs[a][b], a, b});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::cost);
  std::vector<std::size_t> group_of(count);
  std::vector<std::vector<std::size_t>> groups(count);
  for (std::size_t i = 0; i < count; ++i) {
    group_of[i] = i;
    groups[i] = {i};
  }
  for (const Pair& pair : pairs) {
    const std::size_t a = group_of[pair.a];
    const std::size_t b = group_of[pair.b];
    if (a == b) continue;
    const bool fits = std::ranges::all_of(groups[a], [&](std::size_t i) {
      return std::ranges::all_of(groups[b], [&](std::size_t k) { return costs[i][k] < kWorstPair; });
    });
    if (!fits) continue;
    for (const std::size_t member : groups[b]) group_of[member] = a;
    groups[a].insert(groups[a].end(), groups[b].begin(), groups[b].end());
    groups[b].clear();
  }
  std::vector<std::vector<LaneSighting>> found;
  for (const std::vector<std::size_t>& group : groups) {
    if (group.size() < 2) continue;
    std::vector<LaneSighting>& person = found.emplace_back();
    for (const std::size_t member : group) person.push_back(sightings[member]);
  }
  return found;
}

}  // namespace canonpose
