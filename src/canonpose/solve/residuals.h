// The terms of the bundle adjustment, as Ceres cost functions. See rig_estimate.h for the parameters.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>

namespace canonpose {

/// The smallest depth that points are projected at, in body units, so that the cost stays finite when a step of the
/// solver puts one behind a camera.
inline constexpr double kMinDepth = 0.02;

/// Where a camera without distortion shows a joint, normalised image coordinates. kRootCentred: cameras move, and
/// placement is (root x, root y, log scale). False where that cannot be computed: the solver takes a smaller step.
template <bool kRootCentred, typename T>
bool ProjectJoint(const T* quaternion, const T* placement, const T* log_focal, const T* joint, T* projected) {
  using std::exp;
  T p[3];
  ceres::QuaternionRotatePoint(quaternion, joint, p);
  const T focal = exp(*log_focal);
  if constexpr (kRootCentred) {
    const T scale = exp(placement[2]);
    if (!(scale > T(1e-9)) || !(scale < T(1e9))) return false;
    p[0] += placement[0] / scale;
    p[1] += placement[1] / scale;
    p[2] += focal / scale;
  } else {
    for (int i = 0; i < 3; ++i) p[i] += placement[i];
  }
  const T depth = p[2] < T(kMinDepth) ? T(kMinDepth) : p[2];
  for (int i = 0; i < 2; ++i) projected[i] = focal * p[i] / depth;
  return true;
}

/// weight * (projected - observed), 2 residuals; parameters quaternion (4), placement (3), log focal length (1), joint
/// (3).
template <bool kRootCentred>
struct ReprojectionTerm {
  Eigen::Vector2d observed;
  double weight;

  template <typename T>
  bool operator()(const T* quaternion, const T* placement, const T* log_focal, const T* joint, T* residual) const {
    T projected[2];
    if (!ProjectJoint<kRootCentred>(quaternion, placement, log_focal, joint, projected)) return false;
    for (int i = 0; i < 2; ++i) residual[i] = weight * (projected[i] - observed[i]);
    return true;
  }
  static ceres::CostFunction* Create(const Eigen::Vector2d& observed, double weight) {
    return new ceres::AutoDiffCostFunction<ReprojectionTerm, 2, 4, 3, 1, 3>(new ReprojectionTerm{observed, weight});
  }
};

/// The same through a lens that distorts: weight * (distorted - observed), where `observed` is distorted, too; a fifth
/// parameter is RadialLens::at_corner (2).
template <bool kRootCentred>
struct LensReprojectionTerm {
  Eigen::Vector2d observed;
  double weight;

  template <typename T>
  bool operator()(const T* quaternion, const T* placement, const T* log_focal, const T* joint, const T* at_corner,
                  T* residual) const {
    constexpr double kSquaredCorner = 0.25;
    T projected[2];
    if (!ProjectJoint<kRootCentred>(quaternion, placement, log_focal, joint, projected)) return false;
    const T square = (projected[0] * projected[0] + projected[1] * projected[1]) / kSquaredCorner;
    const T factor = 1.0 + square * (at_corner[0] + square * at_corner[1]);
    for (int i = 0; i < 2; ++i) residual[i] = weight * (factor * projected[i] - observed[i]);
    return true;
  }
  static ceres::CostFunction* Create(const Eigen::Vector2d& observed, double weight) {
    return new ceres::AutoDiffCostFunction<LensReprojectionTerm, 2, 4, 3, 1, 3, 2>(
        new LensReprojectionTerm{observed, weight});
  }
};

/// What a view with a known camera sees of a joint: projection = focal * (R x + t)_xy / z.
struct KnownView {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double focal;
  Eigen::Vector2d observed;
  double weight;
};

/// All views of a joint at once, 2V residuals; parameter joint (3). The term is robust by itself: a view whose weighted
/// error is e contributes s^2 log(1 + e^2 / s^2) to the squared norm, which is Cauchy's loss of scale s. A loss
/// function around the block would apply to all views together.
class JointInViewsTerm : public ceres::CostFunction {
 public:
  JointInViewsTerm(std::vector<KnownView> views, double loss_scale)
      : views_(std::move(views)), loss_scale_(loss_scale) {
    set_num_residuals(2 * static_cast<int>(views_.size()));
    mutable_parameter_block_sizes()->push_back(3);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d joint = Eigen::Vector3d::Map(parameters[0]);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const KnownView& view = views_[v];
      const Eigen::Vector3d p = view.rotation * joint + view.translation;
      const double depth = std::max(p.z(), kMinDepth);
      const Eigen::Vector2d raw = view.weight * (view.focal * p.head<2>() / depth - view.observed);
      // |out|^2 = s^2 log(1 + |raw|^2 / s^2): out = g(|raw|^2) raw.
      const double squares = raw.squaredNorm();
      const double relative = squares / (loss_scale_ * loss_scale_);
      const double g = relative < 1e-8 ? 1.0 - 0.25 * relative : std::sqrt(std::log1p(relative) / relative);
      Eigen::Map<Eigen::Vector2d> out(residuals + 2 * v);
      out = g * raw;
      if (jacobians == nullptr || jacobians[0] == nullptr) continue;
      Eigen::Matrix<double, 2, 3> of_raw;
      const double factor = view.weight * view.focal / depth;
      of_raw.row(0) = factor * view.rotation.row(0);
      of_raw.row(1) = factor * view.rotation.row(1);
      if (p.z() > kMinDepth) of_raw -= factor / depth * p.head<2>() * view.rotation.row(2);
      // dg/d(squares) = (1 / (1 + relative) - log1p(relative) / relative) / (2 g squares)
      const double slope = relative < 1e-8
                               ? -0.25 / (loss_scale_ * loss_scale_)
                               : (1.0 / (1.0 + relative) - std::log1p(relative) / relative) / (2.0 * g * squares);
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> jacobian(jacobians[0] + 6 * v);
      jacobian = g * of_raw + 2.0 * slope * raw * (raw.transpose() * of_raw);
    }
    return true;
  }

 private:
  std::vector<KnownView> views_;
  double loss_scale_;
};

/// weight * log(|a - b| / bone length), 1 residual; parameters joint a (3), joint b (3), log bone length (1).
struct BoneTerm {
  double weight;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* log_length, T* residual) const {
    using std::log;
    T squares = T(1e-12);
    for (int i = 0; i < 3; ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    residual[0] = weight * (T(0.5) * log(squares) - *log_length);
    return true;
  }
  static ceres::CostFunction* Create(double weight) {
    return new ceres::AutoDiffCostFunction<BoneTerm, 1, 3, 3, 1>(new BoneTerm{weight});
  }
};

/// weight * mean over bodies of log(sum of the body's bone lengths), 1 residual; parameters log bone lengths (1 each),
/// one body's after the other's. Fixes the unit, which keypoints leave open; without it, smoothness would make
/// everything shrink.
class UnitTerm : public ceres::CostFunction {
 public:
  /// `bones`: how many each body has.
  UnitTerm(std::vector<int> bones, double weight)
      : bones_(std::move(bones)), weight_(weight / static_cast<double>(bones_.size())) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(static_cast<std::size_t>(std::accumulate(bones_.begin(), bones_.end(), 0)),
                                            1);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = 0.0;
    std::size_t first = 0;
    for (const int bones : bones_) {
      const std::size_t end = first + static_cast<std::size_t>(bones);
      double sum = 0.0;
      for (std::size_t b = first; b < end; ++b) sum += std::exp(*parameters[b]);
      residuals[0] += weight_ * std::log(sum);
      for (std::size_t b = first; jacobians != nullptr && b < end; ++b) {
        if (jacobians[b] != nullptr) jacobians[b][0] = weight_ * std::exp(*parameters[b]) / sum;
      }
      first = end;
    }
    return true;
  }

 private:
  std::vector<int> bones_;
  double weight_;
};

/// weight * (a - 2 b + c), 3 residuals; parameters the joint (3) in three successive frames.
class AccelerationTerm : public ceres::SizedCostFunction<3, 3, 3, 3> {
 public:
  explicit AccelerationTerm(double weight) : weight_(weight) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    constexpr double kFactors[3] = {1.0, -2.0, 1.0};
    for (int i = 0; i < 3; ++i) {
      residuals[i] = weight_ * (parameters[0][i] - 2.0 * parameters[1][i] + parameters[2][i]);
    }
    for (int block = 0; jacobians != nullptr && block < 3; ++block) {
      if (jacobians[block] == nullptr) continue;
      Eigen::Map<Eigen::Matrix3d> jacobian(jacobians[block]);
      jacobian = weight_ * kFactors[block] * Eigen::Matrix3d::Identity();
    }
    return true;
  }

 private:
  double weight_;
};

/// log(a^-1 b) of unit quaternions as a rotation vector.
template <typename T>
void RotationBetween(const T* a, const T* b, T* vector) {
  const T inverse[4] = {a[0], -a[1], -a[2], -a[3]};
  T between[4];
  ceres::QuaternionProduct(inverse, b, between);
  ceres::QuaternionToAngleAxis(between, vector);
}

/// weight * rotation vector of a camera from one frame to the next, 3 residuals; parameters quaternion (4) in both.
struct AngularVelocityTerm {
  double weight;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    RotationBetween(a, b, residual);
    for (int i = 0; i < 3; ++i) residual[i] *= weight;
    return true;
  }
  static ceres::CostFunction* Create(double weight) {
    return new ceres::AutoDiffCostFunction<AngularVelocityTerm, 3, 4, 4>(new AngularVelocityTerm{weight});
  }
};

/// weight * change of that rotation vector, 3 residuals; parameters quaternion (4) in three successive frames.
struct AngularAccelerationTerm {
  double weight;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, T* residual) const {
    T first[3];
    T second[3];
    RotationBetween(a, b, first);
    RotationBetween(b, c, second);
    for (int i = 0; i < 3; ++i) residual[i] = weight * (second[i] - first[i]);
    return true;
  }
  static ceres::CostFunction* Create(double weight) {
    return new ceres::AutoDiffCostFunction<AngularAccelerationTerm, 3, 4, 4, 4>(new AngularAccelerationTerm{weight});
  }
};

/// weight * (b - a), 1 residual; parameters log focal length (1) twice.
struct ZoomTerm {
  double weight;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    residual[0] = weight * (*b - *a);
    return true;
  }
  static ceres::CostFunction* Create(double weight) {
    return new ceres::AutoDiffCostFunction<ZoomTerm, 1, 1, 1>(new ZoomTerm{weight});
  }
};

/// weight * (log scale - expected), 1 residual; parameter placement (3) of a moving camera.
struct ScalePriorTerm {
  double expected;
  double weight;

  template <typename T>
  bool operator()(const T* placement, T* residual) const {
    residual[0] = weight * (placement[2] - expected);
    return true;
  }
  static ceres::CostFunction* Create(double expected, double weight) {
    return new ceres::AutoDiffCostFunction<ScalePriorTerm, 1, 3>(new ScalePriorTerm{expected, weight});
  }
};

/// weight * (a - expected), 1 residual.
struct PriorTerm {
  double expected;
  double weight;

  template <typename T>
  bool operator()(const T* a, T* residual) const {
    residual[0] = weight * (*a - expected);
    return true;
  }
  static ceres::CostFunction* Create(double expected, double weight) {
    return new ceres::AutoDiffCostFunction<PriorTerm, 1, 1>(new PriorTerm{expected, weight});
  }
};

/// weights * RadialLens::at_corner, 2 residuals.
struct LensPriorTerm {
  Eigen::Vector2d weights;

  template <typename T>
  bool operator()(const T* at_corner, T* residual) const {
    for (int i = 0; i < 2; ++i) residual[i] = weights[i] * at_corner[i];
    return true;
  }
  static ceres::CostFunction* Create(const Eigen::Vector2d& weights) {
    return new ceres::AutoDiffCostFunction<LensPriorTerm, 2, 2>(new LensPriorTerm{weights});
  }
};

/// weights * the difference of RadialLens::at_corner of two lenses, 2 residuals.
struct LensDifferenceTerm {
  Eigen::Vector2d weights;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    for (int i = 0; i < 2; ++i) residual[i] = weights[i] * (b[i] - a[i]);
    return true;
  }
  static ceres::CostFunction* Create(const Eigen::Vector2d& weights) {
    return new ceres::AutoDiffCostFunction<LensDifferenceTerm, 2, 2, 2>(new LensDifferenceTerm{weights});
  }
};

}  // namespace canonpose
