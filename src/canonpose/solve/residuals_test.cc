#include "canonpose/solve/residuals.h"

#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <ceres/manifold.h>
#include <gtest/gtest.h>

#include "canonpose/solve/lens.h"

namespace canonpose {
namespace {

/// Compares a term's Jacobians with numeric ones. Blocks of four parameters are unit quaternions.
void ExpectRightJacobians(const ceres::CostFunction& term, const std::vector<std::vector<double>>& parameters) {
  constexpr double kRelativePrecision = 1e-7;
  const ceres::QuaternionManifold quaternion;
  std::vector<const ceres::Manifold*> manifolds;
  std::vector<const double*> blocks;
  for (const std::vector<double>& block : parameters) {
    manifolds.push_back(block.size() == 4 ? &quaternion : nullptr);
    blocks.push_back(block.data());
  }
  ceres::NumericDiffOptions numeric;
  // From the default of 1e-2 the extrapolation of Ridders' method can settle on a wrong limit.
  numeric.ridders_relative_initial_step_size = 1e-3;
  const ceres::GradientChecker checker(&term, &manifolds, numeric);
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks.data(), kRelativePrecision, &results)) << results.error_log;
}

std::vector<double> Quaternion(double angle, const Eigen::Vector3d& axis) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis.normalized()));
  return {q.w(), q.x(), q.y(), q.z()};
}

TEST(Residuals, ReprojectionOfStaticCamera) {
  const std::unique_ptr<ceres::CostFunction> term(ReprojectionTerm<false>::Create({0.1, -0.2}, 30.0));
  ExpectRightJacobians(*term, {Quaternion(0.7, {1, 2, 3}), {0.1, -0.3, 1.4}, {0.2}, {0.1, 0.2, -0.15}});
}

TEST(Residuals, ReprojectionOfMovingCamera) {
  const std::unique_ptr<ceres::CostFunction> term(ReprojectionTerm<true>::Create({0.1, -0.2}, 30.0));
  ExpectRightJacobians(*term, {Quaternion(-1.1, {3, 1, 2}), {0.05, -0.1, -0.8}, {0.4}, {0.1, 0.2, -0.15}});
}

TEST(Residuals, ReprojectionThroughALens) {
  const std::unique_ptr<ceres::CostFunction> of_static(LensReprojectionTerm<false>::Create({0.1, -0.2}, 30.0));
  ExpectRightJacobians(*of_static,
                       {Quaternion(0.7, {1, 2, 3}), {0.1, -0.3, 1.4}, {0.2}, {0.1, 0.2, -0.15}, {-0.2, 0.06}});
  const std::unique_ptr<ceres::CostFunction> of_moving(LensReprojectionTerm<true>::Create({0.1, -0.2}, 30.0));
  ExpectRightJacobians(*of_moving,
                       {Quaternion(-1.1, {3, 1, 2}), {0.05, -0.1, -0.8}, {0.4}, {0.1, 0.2, -0.15}, {0.1, -0.03}});
}

TEST(Residuals, TheLensOfTheTermIsRadialLens) {
  const RadialLens lens{{-0.3, 0.1}};
  const Eigen::Vector2d projected(0.25, -0.2);  // by a camera that looks along z, with a focal length of 1
  const std::unique_ptr<ceres::CostFunction> term(LensReprojectionTerm<false>::Create(lens.Distort(projected), 30.0));
  const double quaternion[] = {1.0, 0.0, 0.0, 0.0};
  const double placement[] = {0.0, 0.0, 0.0};
  const double log_focal = 0.0;
  const double joint[] = {2.0 * projected.x(), 2.0 * projected.y(), 2.0};
  const double* parameters[] = {quaternion, placement, &log_focal, joint, lens.at_corner.data()};
  double residuals[2];
  ASSERT_TRUE(term->Evaluate(parameters, residuals, nullptr));
  EXPECT_NEAR(residuals[0], 0.0, 1e-12);
  EXPECT_NEAR(residuals[1], 0.0, 1e-12);
}

TEST(Residuals, JointInViewsAlsoBehindACamera) {
  std::vector<KnownView> views;
  views.push_back(
      {Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).toRotationMatrix(), {0.1, 0.0, 2.0}, 1.2, {0.05, -0.1}, 50.0});
  views.push_back({Eigen::AngleAxisd(-1.4, Eigen::Vector3d(0.1, 1.0, 0.0).normalized()).toRotationMatrix(),
                   {-0.2, 0.1, 1.5},
                   0.9,
                   {-0.4, 0.3},
                   20.0});
  // The joint is behind the last camera.
  views.push_back({Eigen::Matrix3d::Identity(), {0.0, 0.0, -1.0}, 1.0, {0.0, 0.0}, 1.0});
  ExpectRightJacobians(JointInViewsTerm(views, 2.0), {{0.12, 0.2, -0.1}});
}

TEST(Residuals, JointInViewsIsCauchysLossViewByView) {
  const KnownView view{Eigen::Matrix3d::Identity(), {0.0, 0.0, 2.0}, 1.0, {0.3, -0.1}, 10.0};
  const JointInViewsTerm term({view}, 2.0);
  const double joint[] = {0.0, 0.0, 0.0};
  const double* parameters[] = {joint};
  double residuals[2];
  ASSERT_TRUE(term.Evaluate(parameters, residuals, nullptr));
  const double squares = 100.0 * (0.3 * 0.3 + 0.1 * 0.1);
  EXPECT_NEAR(residuals[0] * residuals[0] + residuals[1] * residuals[1], 4.0 * std::log1p(squares / 4.0), 1e-12);
}

TEST(Residuals, Bones) {
  const std::unique_ptr<ceres::CostFunction> term(BoneTerm::Create(33.0));
  ExpectRightJacobians(*term, {{0.1, 0.2, 0.3}, {0.05, -0.1, 0.35}, {-2.0}});
}

TEST(Residuals, Unit) {
  const UnitTerm term({2, 1}, 10.0);
  ExpectRightJacobians(term, {{-1.0}, {-2.0}, {-0.5}});
  const double log_lengths[] = {std::log(0.2), std::log(0.3), std::log(2.0)};  // one body half, one twice the unit
  const double* parameters[] = {&log_lengths[0], &log_lengths[1], &log_lengths[2]};
  double residual;
  ASSERT_TRUE(term.Evaluate(parameters, &residual, nullptr));
  EXPECT_NEAR(residual, 0.0, 1e-12);
}

TEST(Residuals, Accelerations) {
  ExpectRightJacobians(AccelerationTerm(7.0), {{0.1, 0.2, 0.3}, {0.2, 0.1, 0.5}, {-0.1, 0.0, 0.4}});
}

TEST(Residuals, AngularVelocityAndAcceleration) {
  const std::vector<double> a = Quaternion(0.3, {1, 2, 3});
  const std::vector<double> b = Quaternion(0.5, {1, 1, 3});
  const std::vector<double> c = Quaternion(0.6, {1, 0, 3});
  const std::unique_ptr<ceres::CostFunction> velocity(AngularVelocityTerm::Create(5.0));
  ExpectRightJacobians(*velocity, {a, b});
  const std::unique_ptr<ceres::CostFunction> acceleration(AngularAccelerationTerm::Create(5.0));
  ExpectRightJacobians(*acceleration, {a, b, c});
}

TEST(Residuals, ZoomAndPriors) {
  const std::unique_ptr<ceres::CostFunction> zoom(ZoomTerm::Create(3.0));
  ExpectRightJacobians(*zoom, {{0.2}, {0.5}});
  const std::unique_ptr<ceres::CostFunction> prior(PriorTerm::Create(0.3, 2.0));
  ExpectRightJacobians(*prior, {{0.9}});
  const std::unique_ptr<ceres::CostFunction> scale(ScalePriorTerm::Create(-0.8, 2.0));
  ExpectRightJacobians(*scale, {{0.1, 0.2, -0.5}});
  const std::unique_ptr<ceres::CostFunction> lens(LensPriorTerm::Create({3.0, 5.0}));
  ExpectRightJacobians(*lens, {{-0.2, 0.1}});
  const std::unique_ptr<ceres::CostFunction> lenses(LensDifferenceTerm::Create({3.0, 5.0}));
  ExpectRightJacobians(*lenses, {{-0.2, 0.1}, {0.1, 0.05}});
}

}  // namespace
}  // namespace canonpose
