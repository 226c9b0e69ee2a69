#include "canonpose/data/readers/benchmarks/anatomy.h"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;

/// Legs of children to very tall people, with a margin for differing annotations.
constexpr double kShortestLegMm = 300.0;
constexpr double kLongestLegMm = 1300.0;
/// A leg bent by less than this fraction of its length does not show to which side it bends.
constexpr double kBent = 0.01;
constexpr int kFewestFrames = 5;
/// The sides are clear where this fraction of the frames agrees on them.
constexpr double kAgreeingFraction = 0.75;

/// Joints of one pose by the part of the body that they are.
class Pose {
 public:
  Pose(const Skeleton& layout, const float* values) : layout_(layout), values_(values) {}

  /// NaN where the layout or the frame lacks the joint.
  [[nodiscard]] Vector3d operator[](std::string_view part) const {
    const std::optional<int> joint = FindPart(layout_, part);
    if (!joint) return Vector3d::Constant(std::nan(""));
    const float* const value = values_ + static_cast<std::ptrdiff_t>(3) * *joint;
    return {value[0], value[1], value[2]};
  }

 private:
  const Skeleton& layout_;
  const float* values_;
};

/// A few hundred poses at most, evenly spaced.
std::vector<Pose> SomePoses(const Skeleton& layout, const std::vector<float>& poses) {
  constexpr std::size_t kEnough = 400;
  const std::size_t size = layout.joints.size() * 3;
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / size / kEnough);
  std::vector<Pose> some;
  for (std::size_t t = 0; (t + 1) * size <= poses.size(); t += stride) some.emplace_back(layout, &poses[t * size]);
  return some;
}

/// How far in front of legs and head both knees and the nose are, in lengths of a leg; `right` points to the right.
double Ahead(const Pose& pose, const Vector3d& right) {
  const Vector3d hips = 0.5 * (pose["lhip"] + pose["rhip"]);
  const Vector3d shoulders = 0.5 * (pose["lshoulder"] + pose["rshoulder"]);
  const Vector3d forward = (shoulders - hips).cross(right).normalized();
  double ahead = 0.0;
  double leg_length = 0.0;
  for (const char* const side : {"l", "r"}) {
    const Vector3d hip = pose[fmt::format("{}hip", side)];
    const Vector3d knee = pose[fmt::format("{}knee", side)];
    const Vector3d leg = pose[fmt::format("{}ankle", side)] - hip;
    leg_length = leg.norm();
    const Vector3d off = (knee - hip) - leg * ((knee - hip).dot(leg) / leg.squaredNorm());
    ahead += off.dot(forward);
  }
  const Vector3d face = pose["nose"] - 0.5 * (shoulders + pose["headtop"]);
  if (face.allFinite()) ahead += face.dot(forward);
  return ahead / leg_length;
}

/// Whether left and right are swapped: true, false, or nothing where the frames do not agree.
std::optional<bool> IsSwapped(const Skeleton& layout, const std::vector<float>& poses, const char* left,
                              const char* right) {
  int ahead = 0;
  int behind = 0;
  for (const Pose& pose : SomePoses(layout, poses)) {
    const double value = Ahead(pose, pose[right] - pose[left]);
    if (value > kBent) ++ahead;
    if (value < -kBent) ++behind;
  }
  const int total = ahead + behind;
  if (total < kFewestFrames) return std::nullopt;
  if (ahead >= kAgreeingFraction * total) return false;
  if (behind >= kAgreeingFraction * total) return true;
  return std::nullopt;
}

}  // namespace

PoseUnit DetectUnit(const Skeleton& layout, const std::vector<float>& poses, const std::string& file,
                    const std::string& place) {
  std::vector<double> lengths;
  for (const Pose& pose : SomePoses(layout, poses)) {
    for (const char* const side : {"l", "r"}) {
      const Vector3d knee = pose[fmt::format("{}knee", side)];
      const double length =
          (pose[fmt::format("{}hip", side)] - knee).norm() + (pose[fmt::format("{}ankle", side)] - knee).norm();
      if (std::isfinite(length)) lengths.push_back(length);
    }
  }
  if (lengths.empty()) return {};
  const double leg = Median(std::move(lengths));
  static constexpr std::array<std::pair<double, const char*>, 3> kUnits = {{{1.0, "mm"}, {10.0, "cm"}, {1000.0, "m"}}};
  for (const auto& [mm_per_unit, name] : kUnits) {
    const double leg_mm = leg * mm_per_unit;
    if (leg_mm >= kShortestLegMm && leg_mm <= kLongestLegMm) return {mm_per_unit, name, leg_mm};
  }
  ThrowBadInput({file, place, fmt::format("legs of {:.0f} to {:.0f} mm, in mm, cm or m", kShortestLegMm, kLongestLegMm),
                 fmt::format("legs of {:.3g} units", leg), "check that these are the benchmark's original poses"});
}

void ReportUnit(const PoseUnit& unit, const std::string& what) {
  if (unit.name != "mm") {
    LogWarning("{} is in {}, by the length of legs; converted to mm", what, unit.name);
  } else if (unit.leg_mm > 0.0) {
    LogInfo("{} is in mm: legs are {:.0f} mm long", what, unit.leg_mm);
  }
}

SideCheck CheckSides(const Skeleton& layout, const std::vector<float>& poses) {
  const std::optional<bool> arms = IsSwapped(layout, poses, "lshoulder", "rshoulder");
  const std::optional<bool> legs = IsSwapped(layout, poses, "lhip", "rhip");
  if (!arms || !legs) return {};
  return {true, *arms, *legs};
}

void SideReport::Add(const SideCheck& sides, const std::string& what) {
  if (sides.arms_swapped && sides.legs_swapped) all_.push_back(what);
  if (sides.legs_swapped && !sides.arms_swapped) legs_.push_back(what);
  if (sides.arms_swapped && !sides.legs_swapped) arms_.push_back(what);
}

void SideReport::Warn() const {
  for (const auto& [what, names] :
       {std::pair("left and right look", &all_), std::pair("left and right leg look", &legs_),
        std::pair("left and right arm look", &arms_)}) {
    if (names->empty()) continue;
    LogWarning("{}{}: {} swapped, or the knees bend backwards; check the order of the joints", names->front(),
               names->size() > 1 ? fmt::format(" and {} more", names->size() - 1) : "", what);
  }
}

}  // namespace canonpose
