// Rotations of a bone that follow the direction of a limb, with a twist about that direction that stays calm.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace canonpose {

/// Evidence for the twist of a bone: where a direction of its frame points.
struct TwistHint {
  Eigen::Vector3d in_joint = Eigen::Vector3d::Zero();  ///< in the bone's frame, of length 1
  /// In the parent's frame; shorter than 1 where it is less certain, as the normal of a limb that is almost straight.
  Eigen::Vector3d in_parent = Eigen::Vector3d::Zero();
  double weight = 0.0;
};

/// What one frame shows of a bone.
struct Aim {
  bool is_known = false;                                 ///< whether `direction` is
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of the bone in its parent's frame, of length 1
  std::vector<TwistHint> hints;
};

/// A rotation parent_from_joint for each frame. It takes `axis_in_joint` (of length 1) exactly to the direction in each
/// frame where that is known. In other frames it is interpolated between known ones, or held before the first and after
/// the last; it is the identity where no frame is known.
///
/// The twist about the direction minimises, as a complex number of length 1, the weighted squares of its differences
/// from the hints, from no twist (the smallest rotation from rest; very lightly), and from the previous frame's,
/// carried along without twist (with weight `calm`, in frames squared: a hint of weight 1 is averaged over about
/// sqrt(calm) frames). Evidence that is weak is thereby averaged over a longer time.
std::vector<Eigen::Quaterniond> CalmRotations(const Eigen::Vector3d& axis_in_joint, const std::vector<Aim>& aims,
                                              double calm);

}  // namespace canonpose
