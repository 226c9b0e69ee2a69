// Aligning one pose with another: by scale alone, or by a similarity without reflection.
//
// Poses are (N, 3) matrices of the joints that are known in both, in the same order; callers leave out the others.
#pragma once

#include <Eigen/Core>

#include "canonpose/geometry/points.h"

namespace canonpose {

/// The s that minimises |s * from - to|^2: <from, to> / <from, from>; 0 where `from` is all zeros. It is negative where
/// the two point away from each other, as it is in the evaluation of published results.
double LeastSquaresScale(const Points3d& from, const Points3d& to);

/// to = scale * rotation * from + translation; the rotation is proper (determinant 1), the scale is not negative.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Points3d Apply(const Points3d& points) const;
};

/// The similarity without reflection that minimises the sum of squared distances (Umeyama 1991). A single point, or
/// points that all coincide, give scale 0 and the mean of `to`.
Similarity AlignSimilarity(const Points3d& from, const Points3d& to);

/// The rotation nearest to `matrix` in the Frobenius norm; proper even where the determinant is negative.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix);

}  // namespace canonpose
