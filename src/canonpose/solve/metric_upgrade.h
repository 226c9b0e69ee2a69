// From an affine reconstruction to a metric one, in which angles are right.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// keypoint = scale * rows * joint + offset.
using AffineView = Eigen::Matrix<double, 2, 3>;

/// The lower triangular T for which the rows of each view times T are orthogonal and equally long, and the bones of
/// T^-1 times the joints keep their proportions through all frames; frames may differ in size. Views are (V), joints
/// (frames, J), both NaN where unknown. The problem is not convex because of the bones, so several starts are tried.
/// Which of the two mirror solutions T gives is arbitrary. Empty where too little is known.
std::optional<Eigen::Matrix3d> MetricUpgrade(std::span<const AffineView> views, std::span<const Eigen::Vector3d> joints,
                                             const Skeleton& skeleton);

}  // namespace canonpose
