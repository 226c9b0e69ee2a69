// How the joints of one layout are made from the joints of another: by name, never by index.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// One joint of the target as the mean of source joints. With one source it is a copy, with several a derived joint.
struct JointSource {
  std::vector<int> sources;  ///< indices into the source layout; empty where the target joint cannot be made
  [[nodiscard]] bool derived() const { return sources.size() > 1; }
};

/// Target joint t is the mean of joints[t].sources. It is missing where any of its sources is missing; its confidence
/// is the lowest of its sources.
struct LayoutMapping {
  Skeleton source;
  Skeleton target;
  std::vector<JointSource> joints;  ///< (J of the target)

  /// "Hip = mean(LHip, RHip)" for a derived joint, the source's name for a copy; as `info` shows it and files record
  /// it.
  [[nodiscard]] std::string Describe(int target_joint) const;
  [[nodiscard]] std::vector<std::string> DescribeAll() const;
  /// (J) 1 where the joint is derived.
  [[nodiscard]] std::vector<int> derived() const;
};

/// The joint of a layout for a part of the body, whatever the layout calls it: "lknee", "rankle" (foot in h36m-17),
/// "lwrist", "rshoulder", "lhip", "leye", "rear", "lheel", "pelvis", "spine", "thorax", "nose", "headtop". Nothing
/// where the layout has none.
std::optional<int> FindPart(const Skeleton& layout, std::string_view part);

/// Maps joints by the part of the body that they are (their names and aliases, without a prefix: WithoutPrefix()).
/// Joints that a detector lacks are made by the field's convention: pelvis = middle of the hips, thorax = middle of the
/// shoulders (even if there is a neck, which lies higher), spine = mean of hips and shoulders, head = middle of the
/// eyes (of the ears if there are no eyes). Where both layouts have the same names, every joint is a copy. Throws
/// Error(kBadInput) that names the joints that cannot be made.
LayoutMapping MapLayout(const Skeleton& source, const Skeleton& target);

/// The same, but joints that cannot be made have no sources and are therefore always missing.
LayoutMapping MapAvailableJoints(const Skeleton& source, const Skeleton& target);

/// Applies a mapping to one pose. keypoints is (K, 2), confidence (K), of the source; NaN and 0 where missing. The
/// outputs are (J, 2) and (J) of the target.
void ApplyMapping(const LayoutMapping& mapping, const float* keypoints, const float* confidence,
                  float* mapped_keypoints, float* mapped_confidence);

}  // namespace canonpose
