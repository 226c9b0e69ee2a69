#include "canonpose/solve/view_comparison.h"

#include <algorithm>
#include <cmath>

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "canonpose/solve/ceres_options.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/residuals.h"

namespace canonpose {
namespace {

/// Frames from which a camera is estimated anew.
constexpr int kRefitFrames = 40;

Eigen::Vector3d InStaticCamera(const CameraEstimate& camera, const Eigen::Vector3d& joint) {
  return camera.Rotation() * joint + Eigen::Vector3d::Map(camera.placement.data());
}

}  // namespace

ViewComparison::ViewComparison(const CaptureObservations& capture, const Solution& solution, int clip, int view)
    : capture_(capture),
      solution_(solution),
      clip_(capture.clips[static_cast<std::size_t>(clip)]),
      view_(view),
      others_(static_cast<std::size_t>(clip_.count)) {}

std::vector<ViewComparison::Joint>& ViewComparison::OthersAt(int frame) {
  if (frame < clip_.first || frame >= clip_.first + clip_.count) return none_;
  std::vector<Joint>& joints = others_[static_cast<std::size_t>(frame - clip_.first)];
  if (joints.empty()) {
    for (int j = 0; j < capture_.joint_count(); ++j) {
      const RobustPoint found = TriangulateJoint(capture_, frame, j, solution_.scales, solution_.estimate, view_);
      joints.push_back({found.point, found.information.inverse()});
    }
  }
  return joints;
}

CameraEstimate ViewComparison::Refit(std::span<const int> frames, int offset) {
  CameraEstimate camera = solution_.estimate.CameraAt(clip_.first, view_);
  ceres::CauchyLoss loss(kLossScale);
  ceres::QuaternionManifold quaternions;
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  const std::size_t step = std::max<std::size_t>(1, frames.size() / kRefitFrames);
  for (std::size_t i = 0; i < frames.size(); i += step) {
    const int frame = frames[i];
    std::vector<Joint>& joints = OthersAt(frame + offset);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto joint = static_cast<int>(j);
      Eigen::Vector3d& point = joints[j].point;
      if (!capture_.Sees(frame, view_, joint) || !point.allFinite()) continue;
      const double depth = InStaticCamera(camera, point).z();
      if (!(depth > 0.0)) continue;
      const double confidence = capture_.confidence[capture_.Index(frame, view_, joint)];
      const double weight = depth / camera.Focal() / solution_.scales.observation.Scatter(joint, confidence);
      problem.AddResidualBlock(ReprojectionTerm<false>::Create(capture_.At(frame, view_, joint), weight), &loss,
                               camera.quaternion.data(), camera.placement.data(), &camera.log_focal, point.data());
      problem.SetParameterBlockConstant(point.data());
    }
  }
  if (problem.NumResidualBlocks() == 0) return camera;
  problem.SetManifold(camera.quaternion.data(), &quaternions);
  problem.SetParameterBlockConstant(&camera.log_focal);
  ceres::Solver::Summary summary;
  ceres::Solve(SerialOptions(ceres::DENSE_NORMAL_CHOLESKY, 8), &problem, &summary);
  return camera;
}

double ViewComparison::Cost(int frame, int offset, const CameraEstimate& camera) {
  const std::vector<Joint>& joints = OthersAt(frame + offset);
  const Eigen::Matrix3d rotation = camera.Rotation();
  const Eigen::Vector3d translation = Eigen::Vector3d::Map(camera.placement.data());
  double sum = 0.0;
  int count = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto joint = static_cast<int>(j);
    if (!capture_.Sees(frame, view_, joint)) continue;
    const Eigen::Vector3d in_camera = rotation * joints[j].point + translation;
    const double error = DistanceInFront(in_camera, camera.Focal(), capture_.At(frame, view_, joint));
    const double of_joint = VarianceInView(rotation, in_camera, joints[j].covariance);
    if (!std::isfinite(error) || !(of_joint >= 0.0)) continue;
    const double confidence = capture_.confidence[capture_.Index(frame, view_, joint)];
    const double of_keypoint = solution_.scales.observation.Scatter(joint, confidence);
    sum += CauchyLoss(error / std::sqrt(of_keypoint * of_keypoint + of_joint));
    ++count;
  }
  return sum / count;
}

}  // namespace canonpose
