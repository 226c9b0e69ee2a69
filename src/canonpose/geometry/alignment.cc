#include "canonpose/geometry/alignment.h"

#include <limits>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// matrix = u * diag(values) * v^T; `sign` flips the last axis where u * v^T would be a reflection.
struct ProperSvd {
  explicit ProperSvd(const Eigen::Matrix3d& matrix) : svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV) {
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
  }
  [[nodiscard]] Eigen::Matrix3d Rotation() const {
    return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  }

  Eigen::JacobiSVD<Eigen::Matrix3d> svd;
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
};

}  // namespace

double LeastSquaresScale(const Points3d& from, const Points3d& to) {
  const double squares = from.squaredNorm();
  return squares > 0.0 ? from.cwiseProduct(to).sum() / squares : 0.0;
}

Points3d Similarity::Apply(const Points3d& points) const {
  return ((scale * points * rotation.transpose()).rowwise() + translation.transpose()).eval();
}

Similarity AlignSimilarity(const Points3d& from, const Points3d& to) {
  CANONPOSE_CHECK(from.rows() == to.rows() && from.rows() > 0, "{} and {} points", from.rows(), to.rows());
  const Eigen::RowVector3d from_mean = from.colwise().mean();
  const Eigen::RowVector3d to_mean = to.colwise().mean();
  const Points3d from_centred = from.rowwise() - from_mean;
  const Points3d to_centred = to.rowwise() - to_mean;
  const ProperSvd decomposition(to_centred.transpose() * from_centred);

  Similarity similarity;
  const double squares = from_centred.squaredNorm();
  similarity.rotation = decomposition.Rotation();
  similarity.scale = squares > std::numeric_limits<double>::min()
                         ? decomposition.svd.singularValues().dot(decomposition.sign) / squares
                         : 0.0;
  similarity.translation = to_mean.transpose() - similarity.scale * similarity.rotation * from_mean.transpose();
  return similarity;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix) { return ProperSvd(matrix).Rotation(); }

}  // namespace canonpose
