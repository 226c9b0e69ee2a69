#include "canonpose/evaluate/camera_alignment.h"

#include <Eigen/SVD>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// Whether points do not lie on a line, within a thousandth of their extent.
bool SpanAPlane(const Points3d& points) {
  if (points.rows() < 3) return false;
  const Points3d centred = points.rowwise() - points.colwise().mean();
  const Eigen::JacobiSVD<Points3d> svd(centred);
  return svd.singularValues()[1] > 1e-3 * svd.singularValues()[0];
}

}  // namespace

void CameraPairs::Add(const Camera& solved, const Camera& truth) {
  solved_.push_back(solved);
  truth_.push_back(truth);
}

Points3d CameraPairs::Centres(const std::vector<Camera>& cameras) const {
  Points3d centres(size(), 3);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    centres.row(static_cast<Eigen::Index>(i)) =
        -(cameras[i].camera_from_world_rotation.transpose() * cameras[i].camera_from_world_translation).transpose();
  }
  return centres;
}

Similarity CameraPairs::Rigid() const {
  CANONPOSE_CHECK(size() > 0);
  const Points3d solved = Centres(solved_);
  const Points3d truth = Centres(truth_);
  Similarity rigid;
  if (SpanAPlane(solved) && SpanAPlane(truth)) {
    rigid.rotation = AlignSimilarity(solved, truth).rotation;
  } else {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < solved_.size(); ++i) {
      sum += truth_[i].camera_from_world_rotation.transpose() * solved_[i].camera_from_world_rotation;
    }
    rigid.rotation = NearestRotation(sum);
  }
  rigid.translation = truth.colwise().mean().transpose() - rigid.rotation * solved.colwise().mean().transpose();
  return rigid;
}

Similarity CameraPairs::WithScale() const { return AlignSimilarity(Centres(solved_), Centres(truth_)); }

double CameraPairs::MeanDistance(const Similarity& alignment) const {
  return (alignment.Apply(Centres(solved_)) - Centres(truth_)).rowwise().norm().mean();
}

}  // namespace canonpose
