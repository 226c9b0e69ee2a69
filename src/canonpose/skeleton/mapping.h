// How the joints of one layout are made from those of another: by name, never by index.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// One joint of the target as the mean of source joints. One source is a copy; more make it a derived joint.
struct JointSource {
  std::vector<int> sources;  ///< indices into the source layout; empty where the target joint cannot be made
  [[nodiscard]] bool derived() const { return sources.size() > 1; }
};

/// Target joint t is the mean of joints[t].sources. A target is missing where any of its sources is missing, its
/// confidence is the smallest of its sources'.
struct LayoutMapping {
  Skeleton source;
  Skeleton target;
  std::vector<JointSource> joints;  ///< (J of the target)

  /// "Hip = mean(LHip, RHip)" for a derived joint, the source's name for a copy; as `info` shows it and files record
  /// it.
  [[nodiscard]] std::string Describe(int target_joint) const;
  [[nodiscard]] std::vector<std::string> DescribeAll() const;
  /// (J) 1 where derived.
  [[nodiscard]] std::vector<int> derived() const;
};

/// A layout's joint by what it is, whatever the layout calls it: "lknee", "rankle" (foot in h36m-17), "lwrist",
/// "rshoulder", "lhip", "leye", "rear", "lheel", "pelvis", "spine", "thorax", "nose", "headtop"; nothing where the
/// layout lacks it.
std::optional<int> FindPart(const Skeleton& layout, std::string_view part);

/// The mapping by what joints are (their names and aliases), and by the field's rule for joints a detector lacks:
/// pelvis = mid hips, thorax = mid shoulders (also where there is a neck, which lies higher), spine = mean of hips and
/// shoulders, head = mid eyes (mid ears where there are none). Where both layouts have the same names, every joint is a
/// copy. Throws Error(kBadInput) naming the joints that cannot be made.
LayoutMapping MapLayout(const Skeleton& source, const Skeleton& target);

/// The same, but joints that cannot be made have no sources: they are always missing.
LayoutMapping MapWhatCanBe(const Skeleton& source, const Skeleton& target);

/// Applies a mapping to one pose. keypoints is (K, 2), confidence (K), of the source; NaN and 0 where missing. The
/// outputs are (J, 2) and (J) of the target.
void ApplyMapping(const LayoutMapping& mapping, const float* keypoints, const float* confidence,
                  float* mapped_keypoints, float* mapped_confidence);

}  // namespace canonpose
