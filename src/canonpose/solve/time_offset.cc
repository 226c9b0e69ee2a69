#include "canonpose/solve/time_offset.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/residuals.h"
#include "canonpose/solve/view_comparison.h"

namespace canonpose {
namespace {

/// Offsets are searched for in this many runs of consecutive frames of a clip, if it is long enough.
constexpr int kOffsetRuns = 4;
constexpr int kOffsetRunFrames = 60;
/// With fewer frames that can be compared, no offset is found.
constexpr int kMinOffsetFrames = 20;
/// An offset is accepted where it lowers the cost by this many standard errors and this fraction. Chosen by hand.
constexpr double kOffsetSigma = 3.0;
constexpr double kOffsetFraction = 0.05;
/// The camera is estimated at every third offset; offsets between use the nearest estimate.
constexpr int kRefitStep = 3;

double Scatter(const CaptureObservations& capture, const Solution& solution, int frame, int view, int joint) {
  return solution.scales.observation.Scatter(joint, capture.confidence[capture.Index(frame, view, joint)]);
}

/// How well a view fits the others in a clip at each offset -max .. max: a mean cost for each frame that was compared.
class OffsetSearch {
 public:
  OffsetSearch(const CaptureObservations& capture, const Solution& solution, int clip, int view);
  [[nodiscard]] OffsetEstimate Best(bool refine);

 private:
  void Compare(const std::vector<int>& frames);
  /// Measures the offsets around `index` again, each with a camera of its own.
  void CompareAgainAround(std::size_t index);
  [[nodiscard]] double CostOfPair(int frame, int offset) const;

  const CaptureObservations& capture_;
  const Solution& solution_;
  const ClipRange& clip_;
  int view_;
  int other_view_ = -1;  ///< where there are only two
  int max_ = kMaxOffset;
  ViewComparison comparison_;
  std::vector<int> frames_;
  std::vector<std::vector<double>> costs_;  ///< (2 max + 1, frames)
};

OffsetSearch::OffsetSearch(const CaptureObservations& capture, const Solution& solution, int clip, int view)
    : capture_(capture),
      solution_(solution),
      clip_(capture.clips[static_cast<std::size_t>(clip)]),
      view_(view),
      comparison_(capture, solution, clip, view) {
  if (!solution.estimate.CameraAt(clip_.first, view).valid) return;
  const std::vector<int> views = solution.estimate.ValidViews(clip_.first);
  if (views.size() == 2) other_view_ = views[0] == view ? views[1] : views[0];
  max_ = std::min(kMaxOffset, (clip_.count - kMinOffsetFrames) / 2);
  if (max_ < 1) return;
  costs_.resize(static_cast<std::size_t>(2 * max_ + 1));
  // Frames that have all their neighbours.
  const std::vector<int> frames = ConsecutiveFrames(clip_.first + max_, clip_.count - 2 * max_);
  // Where there is room for one run only, all frames are compared.
  const bool has_runs = frames.size() >= 2 * static_cast<std::size_t>(kOffsetRunFrames);
  Compare(has_runs ? EvenRuns(frames, kOffsetRuns, kOffsetRunFrames) : frames);
}

/// Of two views: how well the rays of one in `frame` and of the other in `frame` + `offset` meet, and whether bones
/// keep their lengths.
double OffsetSearch::CostOfPair(int frame, int offset) const {
  std::vector<int> frame_of_view(capture_.cameras.size(), -1);
  frame_of_view[static_cast<std::size_t>(view_)] = frame;
  frame_of_view[static_cast<std::size_t>(other_view_)] = frame + offset;
  const CaptureObservations pair = SingleFrame(capture_, frame_of_view);
  double sum = 0.0;
  int count = 0;
  std::vector<Eigen::Vector3d> joints;
  for (int j = 0; j < capture_.joint_count(); ++j) {
    joints.push_back(TriangulateJoint(pair, 0, j, solution_.scales, solution_.estimate).point);
    if (!joints.back().allFinite()) continue;
    for (const int v : {view_, other_view_}) {
      const CameraEstimate& camera = solution_.estimate.CameraAt(0, v);
      const double error =
          DistanceInFront(solution_.estimate.InCamera(0, v, joints.back()), camera.Focal(), pair.At(0, v, j));
      if (!std::isfinite(error)) continue;
      sum += CauchyLoss(error / Scatter(pair, solution_, 0, v, j));
      ++count;
    }
  }
  const std::vector<double>& lengths = solution_.estimate.log_bone_lengths[static_cast<std::size_t>(clip_.subject)];
  for (int j = 0; j < capture_.joint_count(); ++j) {
    const int parent = capture_.skeleton.parents[static_cast<std::size_t>(j)];
    if (parent < 0) continue;
    const Eigen::Vector3d bone = joints[static_cast<std::size_t>(j)] - joints[static_cast<std::size_t>(parent)];
    const double error = std::log(bone.norm()) - lengths[static_cast<std::size_t>(j)];
    if (std::isfinite(error)) sum += CauchyLoss(error / kBoneScatter);
  }
  return sum / count;
}

void OffsetSearch::Compare(const std::vector<int>& frames) {
  frames_ = frames;
  std::vector<std::vector<double>> costs;
  CameraEstimate camera;
  int refitted_at = INT_MIN;
  for (int offset = -max_; offset <= max_; ++offset) {
    const int nearest = static_cast<int>(std::lround(static_cast<double>(offset) / kRefitStep)) * kRefitStep;
    if (other_view_ < 0 && nearest != refitted_at) {
      camera = comparison_.Refit(frames_, std::clamp(nearest, -max_, max_));
      refitted_at = nearest;
    }
    costs.emplace_back();
    for (const int frame : frames) {
      costs.back().push_back(other_view_ >= 0 ? CostOfPair(frame, offset) : comparison_.Cost(frame, offset, camera));
    }
  }
  // The same frames for all offsets, so that their means can be compared.
  frames_.clear();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!std::ranges::all_of(costs, [i](const std::vector<double>& of_offset) { return std::isfinite(of_offset[i]); }))
      continue;
    frames_.push_back(frames[i]);
    for (std::size_t o = 0; o < costs.size(); ++o) costs_[o].push_back(costs[o][i]);
  }
}

void OffsetSearch::CompareAgainAround(std::size_t index) {
  const auto around = static_cast<int>(index) - max_;
  for (int offset = std::max(-max_, around - kRefitStep + 1); offset <= std::min(max_, around + kRefitStep - 1);
       ++offset) {
    if (offset % kRefitStep == 0) continue;
    const CameraEstimate camera = comparison_.Refit(frames_, offset);
    std::vector<double>& costs = costs_[static_cast<std::size_t>(offset + max_)];
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const double cost = comparison_.Cost(frames_[i], offset, camera);
      if (std::isfinite(cost)) costs[i] = cost;
    }
  }
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

OffsetEstimate OffsetSearch::Best(bool refine) {
  if (static_cast<int>(frames_.size()) < kMinOffsetFrames) return {};
  const auto here = static_cast<std::size_t>(max_);
  std::size_t best = here;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    if (Mean(costs_[i]) < Mean(costs_[best])) best = i;
  }
  if (other_view_ < 0) {
    // With cameras that were estimated at multiples of kRefitStep, these offsets have an advantage.
    CompareAgainAround(best);
    for (std::size_t i = 0; i < costs_.size(); ++i) {
      if (Mean(costs_[i]) < Mean(costs_[best])) best = i;
    }
  }
  if (best == here) return {};
  const int offset = static_cast<int>(best) - max_;
  const double now = Mean(costs_[here]);
  const double gain = now - Mean(costs_[best]);
  if (refine) return {offset, gain};
  if (gain < kOffsetFraction * now) return {};
  std::vector<double> gains;
  for (std::size_t i = 0; i < frames_.size(); ++i) gains.push_back(costs_[here][i] - costs_[best][i]);
  const BlockMean found = MeanOverBlocks(capture_, frames_, gains);
  if (found.blocks < 2 || found.mean < kOffsetSigma * std::sqrt(found.variance)) return {};
  return {offset, found.mean};
}

}  // namespace

OffsetEstimate EstimateOffset(const CaptureObservations& capture, const Solution& solution, int clip, int view,
                              bool refine) {
  return OffsetSearch(capture, solution, clip, view).Best(refine);
}

}  // namespace canonpose
