// From an affine reconstruction to one with right angles.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// keypoint = scale * rows * joint + offset.
using AffineView = Eigen::Matrix<double, 2, 3>;

/// The T (lower triangular) that makes the rows of each view (V; NaN where unknown) times T orthogonal and equally
/// long, and the bones of T^-1 joints (frames, J; NaN where unknown) keep their proportions through all frames,
/// whatever the size of a frame. Found from several starts, since bones make the problem other than convex. Known up to
/// a depth mirror, which a lower triangular T chooses at random. Nothing where too little is known.
std::optional<Eigen::Matrix3d> MetricUpgrade(std::span<const AffineView> views, std::span<const Eigen::Vector3d> joints,
                                             const Skeleton& skeleton);

}  // namespace canonpose
