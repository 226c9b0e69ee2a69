// Skeletons as data: names of joints, their parents, the root and left-right partners.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// J named joints. The same structure describes the skeleton of a dataset and the keypoints a detector finds.
struct Skeleton {
  std::string name;                 ///< "h36m-17"; empty for one that a file defines
  std::vector<std::string> joints;  ///< (J) unique names
  std::vector<int> parents;         ///< (J) index of the joint towards the root; -1 for the root
  int root = 0;                     ///< the joint that poses are centred on
  std::vector<int> mirror;          ///< (J) the left-right partner; the joint itself on the midline

  [[nodiscard]] int joint_count() const { return static_cast<int>(joints.size()); }
  /// Index of a joint by name, ignoring case.
  [[nodiscard]] std::optional<int> Find(std::string_view joint) const;
  /// Empty where the invariants hold, otherwise the first that does not: sizes agree, names are unique, exactly the
  /// root has no parent, every joint leads to the root, mirror is its own inverse.
  [[nodiscard]] std::string Problem() const;
  /// Whether both have the same joints in the same order and the same root, as a model requires of its data.
  [[nodiscard]] bool SameJoints(const Skeleton& other) const;
};

/// The skeleton of some of the joints, in the order of `joints` (indices, the root among them, ascending): a joint
/// whose parent is missing hangs from the nearest ancestor that is there, and one whose partner is missing is its own.
Skeleton Subset(const Skeleton& skeleton, const std::vector<int>& joints);

/// The built-in skeletons and detector layouts, in the order shown to users: h36m-17, canonpose-16, body_25, body_25b,
/// coco-18, coco-17, halpe-26, coco-23 (COCO-WholeBody without face and hands).
const std::vector<Skeleton>& BuiltinSkeletons();

/// A built-in skeleton by name, ignoring case and the difference between '-' and '_'; null where there is none.
const Skeleton* FindSkeleton(std::string_view name);

/// Layouts of benchmarks' annotations. No detector writes them, so they are not candidates when a detector's layout is
/// recognised: 3dhp-28 and 3dhp-17 (MPI-INF-3DHP's training and test set), mpii-16.
const std::vector<Skeleton>& BenchmarkSkeletons();

/// "h36m-17, canonpose-16, ..." for messages.
std::string BuiltinSkeletonNames();

}  // namespace canonpose
