#include "canonpose/solve/metric_upgrade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Dense>
#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "canonpose/base/median.h"
#include "canonpose/solve/ceres_options.h"

namespace canonpose {
namespace {

constexpr int kUpgradeFrames = 150;

/// The lower triangular T of six parameters.
template <typename T>
Eigen::Matrix<T, 3, 3> Upgrade(const T* p) {
  Eigen::Matrix<T, 3, 3> upgrade;
  upgrade << p[0], T(0), T(0), p[1], p[2], T(0), p[3], p[4], p[5];
  return upgrade;
}

/// The rows of M_v T are equally long and orthogonal. 2 residuals, relative to their length.
struct OrthogonalRowsTerm {
  AffineView view;
  double weight;

  template <typename T>
  bool operator()(T const* const* parameters, T* residual) const {
    const Eigen::Matrix<T, 2, 3> rows = view.cast<T>() * Upgrade(parameters[0]);
    const T first = rows.row(0).squaredNorm();
    const T second = rows.row(1).squaredNorm();
    residual[0] = weight * (first - second) / (first + second);
    residual[1] = weight * T(2) * rows.row(0).dot(rows.row(1)) / (first + second);
    return true;
  }
};

/// The bones of a frame are in proportion to the subject's: the differences of their log lengths, less the mean over
/// the frame. Parameters T (6), the subject's log lengths (J).
struct ProportionsTerm {
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> bones;  ///< joint at the end, vector in the affine frame
  double weight;

  template <typename T>
  bool operator()(T const* const* parameters, T* residual) const {
    using std::log;
    const Eigen::Matrix<T, 3, 3> upgrade = Upgrade(parameters[0]);
    T mean(0);
    for (std::size_t b = 0; b < bones.size(); ++b) {
      // T^-1 b by forward substitution.
      const Eigen::Vector3d& bone = bones[b].second;
      const T x = bone.x() / upgrade(0, 0);
      const T y = (bone.y() - upgrade(1, 0) * x) / upgrade(1, 1);
      const T z = (bone.z() - upgrade(2, 0) * x - upgrade(2, 1) * y) / upgrade(2, 2);
      residual[b] = T(0.5) * log(x * x + y * y + z * z + 1e-12) - parameters[1][bones[b].first];
      mean += residual[b] / static_cast<double>(bones.size());
    }
    for (std::size_t b = 0; b < bones.size(); ++b) residual[b] = weight * (residual[b] - mean);
    return true;
  }
};

std::vector<ProportionsTerm> BonesOf(std::span<const Eigen::Vector3d> joints, const Skeleton& skeleton) {
  std::vector<ProportionsTerm> terms;
  const std::size_t joint_count = skeleton.joints.size();
  const std::size_t frame_count = joints.size() / joint_count;
  const std::size_t step = std::max<std::size_t>(1, frame_count / kUpgradeFrames);
  for (std::size_t i = 0; i < frame_count; i += step) {
    ProportionsTerm term{{}, 0.0};
    for (std::size_t j = 0; j < joint_count; ++j) {
      if (skeleton.parents[j] < 0) continue;
      const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
      const Eigen::Vector3d bone = joints[i * joint_count + j] - joints[i * joint_count + parent];
      if (bone.allFinite()) term.bones.emplace_back(j, bone);
    }
    if (term.bones.size() >= 4) terms.push_back(std::move(term));
  }
  // A bone's relative error is taken for a tenth. Errors of neighbouring frames are alike, so that all frames together
  // count for no more than twenty. Both chosen by hand.
  const double weight = 10.0 / std::sqrt(std::max(1.0, static_cast<double>(terms.size()) / 20.0));
  for (ProportionsTerm& term : terms) term.weight = weight;
  return terms;
}

/// Refines T from a start and returns the final cost.
double Refine(std::span<const AffineView> views, std::size_t joint_count, const std::vector<ProportionsTerm>& bones,
              std::array<double, 6>& upgrade) {
  constexpr double kRowScatter = 0.03;
  std::vector<double> lengths(joint_count, 0.0);
  std::vector<std::vector<double>> found(joint_count);
  const Eigen::Matrix3d inverse = Upgrade(upgrade.data()).inverse();
  for (const ProportionsTerm& term : bones) {
    for (const auto& [joint, bone] : term.bones) found[joint].push_back(std::log((inverse * bone).norm() + 1e-6));
  }
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    if (!found[j].empty()) lengths[j] = Median(std::move(found[j]));
  }
  ceres::Problem problem;
  for (const AffineView& view : views) {
    if (!view.allFinite()) continue;
    auto* cost = new ceres::DynamicAutoDiffCostFunction<OrthogonalRowsTerm>(
        new OrthogonalRowsTerm{view / view.norm(), 1.0 / kRowScatter});
    cost->AddParameterBlock(6);
    cost->SetNumResiduals(2);
    problem.AddResidualBlock(cost, nullptr, upgrade.data());
  }
  for (const ProportionsTerm& term : bones) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<ProportionsTerm>(new ProportionsTerm(term));
    cost->AddParameterBlock(6);
    cost->AddParameterBlock(static_cast<int>(lengths.size()));
    cost->SetNumResiduals(static_cast<int>(term.bones.size()));
    problem.AddResidualBlock(cost, new ceres::HuberLoss(1.0), upgrade.data(), lengths.data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SerialOptions(ceres::DENSE_NORMAL_CHOLESKY, 50), &problem, &summary);
  const bool is_sound =
      summary.IsSolutionUsable() && std::ranges::all_of(upgrade, [](double p) { return std::isfinite(p); });
  return is_sound ? summary.final_cost : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<Eigen::Matrix3d> MetricUpgrade(std::span<const AffineView> views, std::span<const Eigen::Vector3d> joints,
                                             const Skeleton& skeleton) {
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  for (const AffineView& view : views) {
    if (view.allFinite()) rows += view.transpose() * view / view.squaredNorm();
  }
  // Cameras all around see every direction equally well: T^T (sum of M^T M) T = 1. That is the first start; the others
  // stretch one direction.
  const std::array<Eigen::Vector3d, 7> stretches = {{{1.0, 1.0, 1.0},
                                                     {2.0, 1.0, 1.0},
                                                     {0.5, 1.0, 1.0},
                                                     {1.0, 2.0, 1.0},
                                                     {1.0, 0.5, 1.0},
                                                     {1.0, 1.0, 2.0},
                                                     {1.0, 1.0, 0.5}}};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(rows);
  const std::vector<ProportionsTerm> bones = BonesOf(joints, skeleton);
  if (bones.empty()) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  std::optional<Eigen::Matrix3d> best;
  const Eigen::Vector3d equal = eigen.eigenvalues().cwiseMax(1e-9).cwiseSqrt().cwiseInverse();
  for (const Eigen::Vector3d& stretch : stretches) {
    const Eigen::Vector3d sizes = equal.cwiseProduct(stretch);
    const Eigen::Matrix3d start = eigen.eigenvectors() * sizes.asDiagonal();
    // T is determined up to a rotation on its right, so the Cholesky factor of T T^T will do.
    const Eigen::Matrix3d lower = (start * start.transpose()).eval().llt().matrixL();
    std::array<double, 6> upgrade = {lower(0, 0), lower(1, 0), lower(1, 1), lower(2, 0), lower(2, 1), lower(2, 2)};
    const double cost = Refine(views, skeleton.joints.size(), bones, upgrade);
    if (!(cost < least)) continue;
    least = cost;
    best = Upgrade(upgrade.data());
  }
  return best;
}

}  // namespace canonpose
