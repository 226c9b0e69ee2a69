#include "canonpose/solve/swaps.h"

#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

using ViewMask = std::uint32_t;

/// What swaps cost, in units of CauchyLoss(). Two views can contradict each other less, so a swap must explain more.
/// Chosen by hand.
struct SwapCosts {
  double frame;   ///< of each frame in which a view is swapped
  double change;  ///< of each view that is swapped in one frame but not in the next, or the other way round
};
constexpr SwapCosts kCostsOfTwoViews = {1.5, 6.0};
constexpr SwapCosts kCostsOfMoreViews = {0.5, 4.0};
/// Of each view beyond the first that is swapped in the same frame.
constexpr double kNextViewCost = 2.0;
/// With more views than this, only one at a time may be swapped.
constexpr int kMaxViewsForPairs = 6;
constexpr int kFramesAtATime = 64;

bool Contains(const std::string& name, std::string_view part) {
  return std::search(name.begin(), name.end(), part.begin(), part.end(),
                     [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; }) != name.end();
}

/// Whether the joint is one of a pair called `top`, or below one.
bool IsBelow(const Skeleton& skeleton, int joint, std::string_view top) {
  for (int j = joint; j >= 0; j = skeleton.parents[static_cast<std::size_t>(j)]) {
    const auto i = static_cast<std::size_t>(j);
    if (skeleton.mirror[i] != j && Contains(skeleton.joints[i], top)) return true;
  }
  return false;
}

void ExchangePairs(CaptureObservations& capture, int frame, int view, const SwapParts::Pairs& pairs) {
  for (const auto& [a, b] : pairs) {
    const std::size_t i = capture.Index(frame, view, a);
    const std::size_t k = capture.Index(frame, view, b);
    std::swap(capture.confidence[i], capture.confidence[k]);
    std::swap(capture.xy[2 * i], capture.xy[2 * k]);
    std::swap(capture.xy[2 * i + 1], capture.xy[2 * k + 1]);
  }
}

/// The sets of views that may be swapped in a frame: none, one, two.
std::vector<ViewMask> Patterns(const std::vector<int>& views) {
  std::vector<ViewMask> patterns = {0};
  for (const int v : views) patterns.push_back(ViewMask{1} << v);
  for (std::size_t a = 0; static_cast<int>(views.size()) <= kMaxViewsForPairs && a < views.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) patterns.push_back(ViewMask{1} << views[a] | ViewMask{1} << views[b]);
  }
  return patterns;
}

/// One frame of a capture by itself, as frame 0, with its cameras.
struct OneFrame {
  CaptureObservations capture;
  RigEstimate estimate;

  OneFrame(const CaptureObservations& whole, const RigEstimate& known, int frame)
      : capture(SingleFrame(whole, std::vector<int>(whole.cameras.size(), frame))), estimate(known.Slice(frame, 1)) {
    estimate.first_frame = 0;
  }
};

/// The joints of a part (2 per pair, in the order of pairs) and their cost under each pattern of a frame.
struct PartFrame {
  std::vector<std::vector<Eigen::Vector3d>> joints;
  std::vector<double> costs;
};

/// One part of the body in all views of a clip.
class PartSearch {
 public:
  PartSearch(const CaptureObservations& capture, const Solution& solution, const std::vector<ViewMask>& patterns,
             const SwapParts::Pairs& pairs, const SwapCosts& costs)
      : capture_(capture), solution_(solution), patterns_(patterns), pairs_(pairs), costs_(costs) {}

  /// The pattern of each frame of a clip.
  [[nodiscard]] std::vector<ViewMask> Find(const ClipRange& clip, int threads) const;

 private:
  [[nodiscard]] PartFrame TryPatterns(int frame) const;
  [[nodiscard]] double ViewCost(const OneFrame& frame, int joint, const Eigen::Vector3d& point) const;
  [[nodiscard]] double BoneCost(int frame, const std::vector<Eigen::Vector3d>& all_joints) const;
  [[nodiscard]] std::vector<double> Steps(const std::vector<PartFrame>& frames) const;

  const CaptureObservations& capture_;
  const Solution& solution_;
  const std::vector<ViewMask>& patterns_;
  const SwapParts::Pairs& pairs_;
  SwapCosts costs_;
};

double PartSearch::ViewCost(const OneFrame& frame, int joint, const Eigen::Vector3d& point) const {
  double cost = 0.0;
  for (int v = 0; v < capture_.view_count(); ++v) {
    const CameraEstimate& camera = frame.estimate.CameraAt(0, v);
    if (!camera.valid || !frame.capture.Sees(0, v, joint)) continue;
    const double error =
        DistanceAtDepth(frame.estimate.InCamera(0, v, point), camera.Focal(), frame.capture.At(0, v, joint));
    const float confidence = frame.capture.confidence[frame.capture.Index(0, v, joint)];
    cost += CauchyLoss(error / solution_.scales.observation.Scatter(joint, confidence));
  }
  return cost;
}

double PartSearch::BoneCost(int frame, const std::vector<Eigen::Vector3d>& all_joints) const {
  const std::vector<double>& lengths =
      solution_.estimate.log_bone_lengths[static_cast<std::size_t>(capture_.ClipOf(frame).subject)];
  double cost = 0.0;
  for (const auto& pair : pairs_) {
    for (const int joint : pair) {
      const auto j = static_cast<std::size_t>(joint);
      const int parent = capture_.skeleton.parents[j];
      if (parent < 0) continue;
      const Eigen::Vector3d bone = all_joints[j] - all_joints[static_cast<std::size_t>(parent)];
      const double error = std::log(bone.norm()) - lengths[j];
      if (std::isfinite(error)) cost += CauchyLoss(error / kBoneScatter);
    }
  }
  return cost;
}

PartFrame PartSearch::TryPatterns(int frame) const {
  PartFrame result;
  OneFrame one(capture_, solution_.estimate, frame);
  std::vector<Eigen::Vector3d> joints;  // all
  for (int j = 0; j < capture_.joint_count(); ++j) {
    joints.push_back(TriangulateJoint(one.capture, 0, j, solution_.scales, one.estimate).point);
  }
  for (const ViewMask pattern : patterns_) {
    const auto exchange = [&] {
      for (int v = 0; v < capture_.view_count(); ++v) {
        if ((pattern >> v & 1) != 0) ExchangePairs(one.capture, 0, v, pairs_);
      }
    };
    exchange();
    double cost = 0.0;
    result.joints.emplace_back();
    for (const auto& pair : pairs_) {
      for (const int j : pair) {
        const Eigen::Vector3d point = TriangulateJoint(one.capture, 0, j, solution_.scales, one.estimate).point;
        if (point.allFinite()) cost += ViewCost(one, j, point);
        joints[static_cast<std::size_t>(j)] = point;
        result.joints.back().push_back(point);
      }
    }
    exchange();
    const int swapped = std::popcount(pattern);
    cost += costs_.frame * swapped + kNextViewCost * std::max(0, swapped - 1);
    result.costs.push_back(cost + BoneCost(frame, joints));
  }
  return result;
}

/// The usual motion of each joint from one frame to the next, in the order of PartFrame's joints; NaN where unknown.
std::vector<double> PartSearch::Steps(const std::vector<PartFrame>& frames) const {
  std::vector<double> steps(2 * pairs_.size(), std::nan(""));
  for (std::size_t j = 0; j < steps.size(); ++j) {
    std::vector<double> lengths;
    for (std::size_t t = 1; t < frames.size(); ++t) {
      const double length = (frames[t].joints[0][j] - frames[t - 1].joints[0][j]).norm();
      if (std::isfinite(length)) lengths.push_back(length);
    }
    if (!lengths.empty()) steps[j] = std::max(Median(std::move(lengths)), solution_.scales.observation.Typical());
  }
  return steps;
}

std::vector<ViewMask> PartSearch::Find(const ClipRange& clip, int threads) const {
  std::vector<PartFrame> frames(static_cast<std::size_t>(clip.count));
  InParallel((clip.count + kFramesAtATime - 1) / kFramesAtATime, threads, [&](int batch) {
    const int end = std::min(clip.count, (batch + 1) * kFramesAtATime);
    for (int t = batch * kFramesAtATime; t < end; ++t)
      frames[static_cast<std::size_t>(t)] = TryPatterns(clip.first + t);
  });
  const std::vector<double> steps = Steps(frames);
  const auto change = [&](int t, int before, int now) {
    const std::vector<Eigen::Vector3d>& from =
        frames[static_cast<std::size_t>(t - 1)].joints[static_cast<std::size_t>(before)];
    const std::vector<Eigen::Vector3d>& to = frames[static_cast<std::size_t>(t)].joints[static_cast<std::size_t>(now)];
    const ViewMask changed = patterns_[static_cast<std::size_t>(before)] ^ patterns_[static_cast<std::size_t>(now)];
    double cost = costs_.change * std::popcount(changed);
    for (std::size_t j = 0; j < steps.size(); ++j) {
      const double step = (to[j] - from[j]).norm();
      if (std::isfinite(step / steps[j])) cost += CauchyLoss(step / steps[j]);
    }
    return cost;
  };
  const auto cost = [&](int t, int state) {
    return frames[static_cast<std::size_t>(t)].costs[static_cast<std::size_t>(state)];
  };
  std::vector<ViewMask> found;
  for (const int state : CheapestPath(clip.count, static_cast<int>(patterns_.size()), cost, change)) {
    found.push_back(patterns_[static_cast<std::size_t>(state)]);
  }
  return found;
}

/// The views whose camera is valid in some frame.
std::vector<int> KnownViews(const CaptureObservations& capture, const RigEstimate& estimate) {
  std::vector<int> known;
  for (int v = 0; v < capture.view_count(); ++v) {
    bool any = false;
    for (int n = 0; n < capture.frame_count && !any; ++n) any = estimate.CameraAt(n, v).valid;
    if (any) known.push_back(v);
  }
  return known;
}

}  // namespace

SwapParts FindSwapParts(const Skeleton& skeleton) {
  SwapParts parts;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int partner = skeleton.mirror[static_cast<std::size_t>(j)];
    if (partner <= j) continue;
    const bool is_leg = IsBelow(skeleton, j, "hip");
    const bool is_arm = !is_leg && IsBelow(skeleton, j, "sho");
    (is_leg ? parts.legs : is_arm ? parts.arms : parts.rest).push_back({j, partner});
  }
  return parts;
}

int CorrectSwaps(CaptureObservations& capture, const Solution& solution, int threads) {
  const std::vector<int> views = KnownViews(capture, solution.estimate);
  if (views.size() < 2 || views.back() >= 32) return 0;
  const std::vector<ViewMask> patterns = Patterns(views);
  const SwapCosts& costs = views.size() == 2 ? kCostsOfTwoViews : kCostsOfMoreViews;
  const SwapParts parts = FindSwapParts(capture.skeleton);
  const std::array<const SwapParts::Pairs*, 3> all = {&parts.legs, &parts.arms, &parts.rest};
  int corrected = 0;
  for (const ClipRange& clip : capture.clips) {
    std::array<std::vector<ViewMask>, 3> found;
    for (std::size_t p = 0; p < all.size(); ++p) {
      found[p] = PartSearch(capture, solution, patterns, *all[p], costs).Find(clip, threads);
    }
    for (int t = 0; t < clip.count; ++t) {
      const auto i = static_cast<std::size_t>(t);
      const int frame = clip.first + t;
      for (const int v : views) {
        for (std::size_t p = 0; p < all.size(); ++p) {
          if ((found[p][i] >> v & 1) != 0) ExchangePairs(capture, frame, v, *all[p]);
        }
        if (((found[0][i] & found[1][i]) >> v & 1) != 0) {
          std::fill_n(&capture.start[3 * capture.Index(frame, v, 0)], 3 * capture.joint_count(), std::nanf(""));
        }
        corrected += ((found[0][i] | found[1][i] | found[2][i]) >> v & 1) != 0 ? 1 : 0;
      }
    }
  }
  return corrected;
}

}  // namespace canonpose
