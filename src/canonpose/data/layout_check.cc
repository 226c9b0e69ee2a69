#include "canonpose/data/layout_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {
namespace {

using Eigen::Vector2d;

/// Above this misfit a layout does not fit: right ones measure at most 1.7, wrong ones at least 2.7.
constexpr double kLargestMisfit = 2.4;
/// The quartiles of only a few frames are less reliable.
constexpr double kLargestMisfitOfFewFrames = 3.2;
constexpr int kFewFrames = 10;
/// A layout is clearly better than another where its misfit is smaller by this factor.
constexpr double kClearlyBetter = 1.25;
/// Frames that show fewer joints at once are not used.
constexpr int kFewestJoints = 7;
/// About as many frames are used of all clips together.
constexpr int kMaxFrames = 400;
/// Foreshortening alone hardly ever makes the median ratio of two parts of a limb larger than this.
constexpr double kOddLimbRatio = 2.5;

/// The joints seen in one frame; index is -1 where a joint is missing.
struct SeenJoints {
  std::vector<Vector2d> points;
  std::vector<int> joint;  ///< of each point
  std::vector<int> index;  ///< (K) into points
};

SeenJoints Seen(const KeypointClip& clip, std::size_t frame) {
  const auto count = static_cast<std::size_t>(clip.keypoint_count);
  SeenJoints seen;
  seen.index.assign(count, -1);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = frame * count + k;
    if (!(clip.confidence[at] > 0.0F)) continue;
    seen.index[k] = static_cast<int>(seen.points.size());
    seen.joint.push_back(static_cast<int>(k));
    seen.points.emplace_back(clip.keypoints[2 * at], clip.keypoints[2 * at + 1]);
  }
  return seen;
}

/// Total length of the shortest tree through the points (Prim's algorithm).
double ShortestTree(const std::vector<Vector2d>& points) {
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> is_in(points.size(), false);
  distance[0] = 0.0;
  double total = 0.0;
  for (std::size_t step = 0; step < points.size(); ++step) {
    std::size_t next = points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!is_in[i] && (next == points.size() || distance[i] < distance[next])) next = i;
    }
    is_in[next] = true;
    total += distance[next];
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!is_in[i]) distance[i] = std::min(distance[i], (points[i] - points[next]).norm());
    }
  }
  return total;
}

/// Mean edge of the layout's tree divided by that of the shortest tree. A missing joint is left out of the tree, and
/// its children are attached to its nearest visible ancestor. 0 where too few joints are seen.
double TreeRatio(const Skeleton& layout, const SeenJoints& seen) {
  const auto count = static_cast<int>(seen.points.size());
  if (count < kFewestJoints) return 0.0;
  double length = 0.0;
  int edges = 0;
  for (std::size_t p = 0; p < seen.points.size(); ++p) {
    int ancestor = layout.parents[static_cast<std::size_t>(seen.joint[p])];
    while (ancestor >= 0 && seen.index[static_cast<std::size_t>(ancestor)] < 0) {
      ancestor = layout.parents[static_cast<std::size_t>(ancestor)];
    }
    if (ancestor < 0) continue;
    const auto other = static_cast<std::size_t>(seen.index[static_cast<std::size_t>(ancestor)]);
    length += (seen.points[p] - seen.points[other]).norm();
    ++edges;
  }
  const double shortest = ShortestTree(seen.points) / (count - 1);
  if (edges == 0 || !(shortest > 0.0)) return 0.0;
  return length / edges / shortest;
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::optional<int> FindAny(const Skeleton& layout, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (const std::optional<int> joint = layout.Find(name)) return joint;
  }
  return std::nullopt;
}

/// Lengths of a layout's edges relative to the person's size, over frames.
class EdgeLengths {
 public:
  explicit EdgeLengths(const Skeleton& layout) : layout_(layout), lengths_(layout.joints.size()) {}

  void Add(const SeenJoints& seen) {
    Vector2d low = seen.points.front();
    Vector2d high = low;
    for (const Vector2d& point : seen.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const double size = (high - low).norm();
    for (std::size_t j = 0; j < lengths_.size(); ++j) {
      const int parent = layout_.parents[j];
      if (parent < 0 || seen.index[j] < 0 || seen.index[static_cast<std::size_t>(parent)] < 0) continue;
      const Vector2d& end = seen.points[static_cast<std::size_t>(seen.index[static_cast<std::size_t>(parent)])];
      lengths_[j].push_back((seen.points[static_cast<std::size_t>(seen.index[j])] - end).norm() / size);
    }
  }

  /// Sum |l - r| / sum (l + r) over the edges that have a partner. The upper quartile over frames evens out
  /// foreshortening.
  [[nodiscard]] double Asymmetry() const {
    double difference = 0.0;
    double sum = 0.0;
    for (std::size_t j = 0; j < lengths_.size(); ++j) {
      const auto partner = static_cast<std::size_t>(layout_.mirror[j]);
      if (partner <= j || lengths_[j].empty() || lengths_[partner].empty()) continue;
      if (layout_.parents[partner] != layout_.mirror[static_cast<std::size_t>(layout_.parents[j])]) continue;
      const double one = Quantile(lengths_[j], 0.75);
      const double other = Quantile(lengths_[partner], 0.75);
      difference += std::abs(one - other);
      sum += one + other;
    }
    return sum > 0.0 ? difference / sum : 0.0;
  }

 private:
  const Skeleton& layout_;
  std::vector<std::vector<double>> lengths_;
};

/// Three successive joints of a limb.
using Limb = std::array<int, 3>;

std::vector<Limb> Limbs(const Skeleton& layout, bool legs) {
  std::vector<Limb> limbs;
  for (const std::string side : {"L", "R"}) {
    const std::optional<int> top =
        legs ? FindAny(layout, {side + "Hip"}) : FindAny(layout, {side + "Shoulder", side + "Sho"});
    const std::optional<int> middle =
        legs ? FindAny(layout, {side + "Knee"}) : FindAny(layout, {side + "Elbow", side + "Elb"});
    const std::optional<int> end =
        legs ? FindAny(layout, {side + "Ankle", side + "Foot"}) : FindAny(layout, {side + "Wrist", side + "Hand"});
    if (top && middle && end) limbs.push_back({*top, *middle, *end});
  }
  return limbs;
}

/// Adds the ratio of upper to lower length of each limb that is completely visible.
void AddLimbRatios(const std::vector<Limb>& limbs, const SeenJoints& seen, std::vector<double>& ratios) {
  for (const Limb& limb : limbs) {
    std::array<int, 3> at{};
    std::transform(limb.begin(), limb.end(), at.begin(),
                   [&](int joint) { return seen.index[static_cast<std::size_t>(joint)]; });
    if (std::any_of(at.begin(), at.end(), [](int index) { return index < 0; })) continue;
    const Vector2d& middle = seen.points[static_cast<std::size_t>(at[1])];
    const double upper = (seen.points[static_cast<std::size_t>(at[0])] - middle).norm();
    const double lower = (seen.points[static_cast<std::size_t>(at[2])] - middle).norm();
    if (upper > 0.0 && lower > 0.0) ratios.push_back(upper / lower);
  }
}

std::vector<LayoutFit> MeasureAll(std::span<const KeypointClip> clips) {
  std::vector<LayoutFit> fits;
  for (const Skeleton& layout : BuiltinSkeletons()) {
    if (layout.joint_count() == clips.front().keypoint_count) fits.push_back(MeasureLayout(layout, clips));
  }
  std::stable_sort(fits.begin(), fits.end(),
                   [](const LayoutFit& a, const LayoutFit& b) { return a.misfit() < b.misfit(); });
  return fits;
}

std::string LayoutsByCount() {
  std::string text;
  for (const Skeleton& layout : BuiltinSkeletons()) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", layout.name, layout.joint_count());
  }
  return text;
}

/// How well a layout explains the keypoints, for messages.
std::string Describe(const LayoutFit& fit) {
  return fmt::format("as {}, limbs are {:.1f} times as long as necessary and left and right differ by {:.0f} %",
                     fit.layout->name, fit.tree_ratio, 100.0 * fit.asymmetry);
}

/// Throws where another layout is clearly better.
[[noreturn]] void ThrowOtherFits(const KeypointClip& clip, const LayoutFit& wrong, const LayoutFit& right,
                                 const std::string& advice) {
  ThrowBadInput({clip.path, "", fmt::format("keypoints in the layout {}", wrong.layout->name),
                 fmt::format("those of {} ({}; {})", right.layout->name, Describe(wrong), Describe(right)), advice});
}

[[noreturn]] void ThrowNothingFits(const KeypointClip& clip, const LayoutFit& best) {
  ThrowBadInput({clip.path, "",
                 fmt::format("the joints of a person in the order of a layout with {} keypoints", clip.keypoint_count),
                 fmt::format("an order that fits none of these: {}", Describe(best)),
                 "the joints are shuffled, or in an unknown layout"});
}

/// Throws where one camera's joints are clearly in another layout than the one chosen for all.
void CheckEachCamera(std::span<const KeypointClip> clips, const Skeleton& layout) {
  for (const KeypointClip& clip : clips) {
    const LayoutFit best = MeasureAll(std::span(&clip, 1)).front();
    const LayoutFit chosen = MeasureLayout(layout, std::span(&clip, 1));
    if (chosen.frames == 0 || chosen.fits()) continue;
    if (!best.fits() || chosen.misfit() < kClearlyBetter * best.misfit()) {
      LogWarning("{}: {}; look at its detections", clip.name, Describe(chosen));
      continue;
    }
    ThrowOtherFits(clip, chosen, best,
                   fmt::format("all cameras must have one layout; camera {} has another", clip.name));
  }
}

const Skeleton& RequestedLayout(const KeypointClip& clip, const std::string& requested) {
  const Skeleton* layout = FindSkeleton(requested);
  if (layout == nullptr)
    ThrowInvalidArgument("there is no layout \"{}\"; the layouts are {}", requested, BuiltinSkeletonNames());
  if (layout->joint_count() != clip.keypoint_count) {
    ThrowBadInput({clip.path, "", fmt::format("{} keypoints for layout {}", layout->joint_count(), layout->name),
                   fmt::format("{}", clip.keypoint_count), "the layouts and their counts are " + LayoutsByCount()});
  }
  return *layout;
}

void WarnOfOddLimbs(const LayoutFit& fit) {
  for (const auto& [name, ratio] :
       {std::pair("thigh / shank", fit.thigh_to_shank), std::pair("upper arm / forearm", fit.upper_arm_to_forearm)}) {
    if (ratio > 0.0 && (ratio > kOddLimbRatio || ratio < 1.0 / kOddLimbRatio)) {
      LogWarning("read as {}, the ratio {} is {:.1f} in the image; check that the joints are in this order",
                 fit.layout->name, name, ratio);
    }
  }
}

}  // namespace

bool LayoutFit::fits() const {
  return frames > 0 && misfit() <= (frames < kFewFrames ? kLargestMisfitOfFewFrames : kLargestMisfit);
}

LayoutFit MeasureLayout(const Skeleton& layout, std::span<const KeypointClip> clips) {
  std::size_t total = 0;
  for (const KeypointClip& clip : clips) total += clip.frame_numbers.size();
  const std::size_t stride = std::max<std::size_t>(1, total / kMaxFrames);
  const std::vector<Limb> legs = Limbs(layout, true);
  const std::vector<Limb> arms = Limbs(layout, false);
  EdgeLengths edges(layout);
  std::vector<double> tree_ratios;
  std::vector<double> leg_ratios;
  std::vector<double> arm_ratios;
  for (const KeypointClip& clip : clips) {
    CANONPOSE_CHECK(clip.keypoint_count == layout.joint_count(), "{} != {}", clip.keypoint_count, layout.joint_count());
    for (std::size_t frame = 0; frame < clip.frame_numbers.size(); frame += stride) {
      const SeenJoints seen = Seen(clip, frame);
      const double ratio = TreeRatio(layout, seen);
      if (ratio > 0.0) {
        tree_ratios.push_back(ratio);
        edges.Add(seen);
      }
      AddLimbRatios(legs, seen, leg_ratios);
      AddLimbRatios(arms, seen, arm_ratios);
    }
  }
  LayoutFit fit;
  fit.layout = &layout;
  fit.frames = static_cast<int>(tree_ratios.size());
  fit.tree_ratio = Quantile(tree_ratios, 0.25);
  fit.asymmetry = edges.Asymmetry();
  fit.thigh_to_shank = Quantile(leg_ratios, 0.5);
  fit.upper_arm_to_forearm = Quantile(arm_ratios, 0.5);
  return fit;
}

const Skeleton& CheckLayout(std::span<const KeypointClip> clips, const std::string& requested) {
  CANONPOSE_CHECK(!clips.empty(), "no clips");
  const KeypointClip& first = clips.front();
  const Skeleton* layout = requested.empty() ? nullptr : &RequestedLayout(first, requested);
  const std::vector<LayoutFit> fits = MeasureAll(clips);
  if (fits.empty()) {
    ThrowBadInput({first.path, "", "as many keypoints as a known layout: " + LayoutsByCount(),
                   fmt::format("{}", first.keypoint_count), "run the detector with one of these layouts"});
  }
  const LayoutFit& best = fits.front();
  const bool is_measured = best.frames > 0;
  if (is_measured && !best.fits()) ThrowNothingFits(first, best);
  if (layout == nullptr) {
    const bool is_decided = fits.size() == 1 || (is_measured && fits[1].misfit() > kClearlyBetter * best.misfit());
    if (!is_decided) {
      ThrowBadInput(
          {first.path, "", fmt::format("`layout` {} or {}", best.layout->name, fits[1].layout->name),
           fmt::format("{} keypoints, with too few joints visible to recognise the layout", first.keypoint_count),
           "name the layout"});
    }
    layout = best.layout;
    LogInfo("layout {}, as there are {} keypoints{}", layout->name, first.keypoint_count,
            fits.size() == 1 ? "" : fmt::format(" in the order of a person ({})", Describe(fits[1])));
  }
  const auto chosen =
      std::find_if(fits.begin(), fits.end(), [&](const LayoutFit& fit) { return fit.layout == layout; });
  const bool is_refuted = is_measured && chosen->misfit() > kClearlyBetter * best.misfit();
  if (is_refuted) {
    ThrowOtherFits(first, *chosen, best, fmt::format("use `layout` {}, or leave `layout` out", best.layout->name));
  }
  if (!is_measured) LogWarning("too few joints are visible together to check that the layout is {}", layout->name);
  if (is_measured) CheckEachCamera(clips, *layout);
  WarnOfOddLimbs(*chosen);
  return *layout;
}

}  // namespace canonpose
