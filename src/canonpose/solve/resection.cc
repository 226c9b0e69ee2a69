#include "canonpose/solve/resection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "canonpose/base/median.h"
#include "canonpose/solve/fit.h"

namespace canonpose {
namespace {

constexpr int kIterations = 8;
constexpr std::size_t kMinSightings = 6;
/// Perspective is not corrected beyond this ratio of a joint's depth to the mean depth, in either direction.
constexpr double kMaxDepthRatio = 4.0;
/// The loss begins at this multiple of the median error and narrows to the keypoints' own scatter.
constexpr double kWide = 1.5;

/// A scaled orthographic camera: image = scale * (rows * (joint - centre)) + offset.
struct ScaledOrthography {
  Eigen::Matrix<double, 2, 3> rows;
  Eigen::Vector2d offset;
  double scale = 0.0;
};

/// Weighted least squares for image_i = A (joint_i - centre) + b; false where the joints lie in a plane.
bool FitAffine(std::span<const Sighting> sightings, const Eigen::Vector3d& centre,
               const std::vector<Eigen::Vector2d>& image, const std::vector<double>& weights,
               ScaledOrthography& camera) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 2> right = Eigen::Matrix<double, 4, 2>::Zero();
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    Eigen::Vector4d row;
    row << sightings[i].joint - centre, 1.0;
    normal.noalias() += weights[i] * row * row.transpose();
    right.noalias() += weights[i] * row * image[i].transpose();
  }
  const Eigen::LDLT<Eigen::Matrix4d> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-9 * factor.vectorD().maxCoeff()))
    return false;
  const Eigen::Matrix<double, 2, 4> affine = factor.solve(right).transpose();
  // The nearest matrix with orthonormal rows, (A A^T)^-1/2 A, and the scale that goes with it.
  const Eigen::Matrix<double, 2, 3> A = affine.leftCols<3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> squares(A * A.transpose());
  if (!(squares.eigenvalues()[0] > 0.0)) return false;
  camera.scale = 0.5 * squares.eigenvalues().cwiseSqrt().sum();
  camera.rows = squares.operatorInverseSqrt() * A;
  camera.offset = affine.col(3);
  return std::isfinite(camera.scale) && camera.scale > 0.0;
}

void SetFrom(const ScaledOrthography& camera, const Eigen::Vector3d& centre, Resection& result) {
  const double focal = std::exp(result.log_focal);
  result.rotation.topRows<2>() = camera.rows;
  result.rotation.row(2) = camera.rows.row(0).cross(camera.rows.row(1));
  const Eigen::Vector3d centre_in_camera(camera.offset.x() / camera.scale, camera.offset.y() / camera.scale,
                                         focal / camera.scale);
  result.translation = centre_in_camera - result.rotation * centre;
}

void MeasureErrors(std::span<const Sighting> sightings, Resection& result) {
  result.errors.clear();
  for (const Sighting& sighting : sightings) result.errors.push_back(result.ErrorOf(sighting));
}

}  // namespace

double Resection::ErrorOf(const Sighting& sighting) const {
  const Eigen::Vector3d in_camera = rotation * sighting.joint + translation;
  if (!(in_camera.z() > 0.0)) return std::numeric_limits<double>::infinity();
  return DistanceAtDepth(in_camera, std::exp(log_focal), sighting.keypoint);
}

CameraEstimate Resection::StaticCamera() const {
  CameraEstimate camera;
  camera.SetRotation(rotation);
  Eigen::Vector3d::Map(camera.placement.data()) = translation;
  camera.log_focal = log_focal;
  camera.valid = valid;
  return camera;
}

Resection Resect(std::span<const Sighting> sightings, double log_focal, double scatter) {
  Resection result;
  result.log_focal = log_focal;
  if (sightings.size() < kMinSightings) return result;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Sighting& sighting : sightings) centre += sighting.joint / static_cast<double>(sightings.size());
  std::vector<Eigen::Vector2d> image;
  for (const Sighting& sighting : sightings) image.push_back(sighting.keypoint);
  std::vector<double> weights(sightings.size(), 1.0);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    ScaledOrthography camera;
    if (!FitAffine(sightings, centre, image, weights, camera)) return result;
    SetFrom(camera, centre, result);
    MeasureErrors(sightings, result);
    const double wide = std::max(scatter, iteration + 2 < kIterations ? kWide * Median(result.errors) : 0.0);
    const double mean_depth = std::exp(log_focal) / camera.scale;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      const double depth = (result.rotation * sightings[i].joint + result.translation).z() / mean_depth;
      image[i] = std::clamp(depth, 1.0 / kMaxDepthRatio, kMaxDepthRatio) * sightings[i].keypoint;
      weights[i] = std::isfinite(result.errors[i]) ? CauchyWeight(result.errors[i] / wide) : 1e-6;
    }
  }
  result.valid = true;
  for (const double error : result.errors) {
    result.cost += CauchyLoss(std::min(error, 1e3) / scatter) / static_cast<double>(sightings.size());
  }
  return result;
}

Resection ResectWithFocal(std::span<const Sighting> sightings, double expected_log_focal, double scatter) {
  constexpr int kSteps = 3;
  constexpr double kStep = std::numbers::ln2 / kSteps;
  Resection best;
  const auto attempt = [&](double log_focal) {
    Resection candidate = Resect(sightings, log_focal, scatter);
    if (candidate.valid && (!best.valid || candidate.cost < best.cost)) best = std::move(candidate);
  };
  for (int step = -kSteps; step <= kSteps; ++step) attempt(expected_log_focal + step * kStep);
  for (const double finer : {0.5 * kStep, 0.25 * kStep, 0.125 * kStep}) {
    const double middle = best.log_focal;
    for (const double sign : {-1.0, 1.0}) attempt(middle + sign * finer);
  }
  return best;
}

}  // namespace canonpose
