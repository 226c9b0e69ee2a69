// Bringing one pose onto another: by scale alone, and by a similarity without reflection.
//
// Poses are (N, 3) matrices of the joints that both know, in the same order; callers leave the unknown ones out.
#pragma once

#include <Eigen/Core>

#include "canonpose/geometry/points.h"

namespace canonpose {

/// The s that makes |s * from - to|^2 least: <from, to> / <from, from>; 0 where `from` is all zeros. Negative where the
/// two point away from each other, as in the formula that published figures were made with.
double LeastSquaresScale(const Points3d& from, const Points3d& to);

/// to = scale * rotation * from + translation; rotation is proper (determinant 1), scale is not negative.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Points3d Apply(const Points3d& points) const;
};

/// The similarity without reflection that makes the sum of squared distances least (Umeyama 1991). A single point, or
/// points that all coincide, give scale 0 and the mean of `to`.
Similarity AlignSimilarity(const Points3d& from, const Points3d& to);

/// The rotation nearest to `matrix` in the Frobenius norm; proper, whatever the sign of the determinant.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace canonpose
