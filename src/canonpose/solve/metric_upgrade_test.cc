#include "canonpose/solve/metric_upgrade.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using testing::MakeExactRig;

/// What a factorisation leaves: views times A, A^-1 times joints, each frame of its own size.
struct AffineCapture {
  Eigen::Matrix3d affine;
  std::vector<AffineView> views;
  std::vector<Eigen::Vector3d> joints;
  Skeleton skeleton;
};

AffineCapture Distort(int view_count) {
  ExactRigOptions options;
  options.views = view_count;
  const ExactRig rig = MakeExactRig(options);
  AffineCapture capture;
  capture.skeleton = rig.capture.skeleton;
  capture.affine << 1.3, 0.2, -0.1, 0.4, 0.7, 0.3, -0.2, 0.1, 1.1;
  for (int v = 0; v < view_count; ++v) {
    capture.views.emplace_back((1.0 + 0.2 * v) * rig.truth.CameraAt(0, v).Rotation().topRows<2>() * capture.affine);
  }
  const Eigen::Matrix3d inverse = capture.affine.inverse();
  for (int n = 0; n < rig.truth.frame_count(); ++n) {
    for (int j = 0; j < rig.truth.joint_count; ++j) {
      capture.joints.emplace_back((1.0 + 0.3 * std::sin(n)) * inverse * rig.truth.Joint(n, j));
    }
  }
  return capture;
}

/// How far A T is from a multiple of an orthogonal matrix.
double Shear(const Eigen::Matrix3d& affine, const Eigen::Matrix3d& upgrade) {
  const Eigen::Matrix3d product = affine * upgrade;
  const Eigen::Matrix3d squares = product * product.transpose();
  return (squares / squares.trace() * 3.0 - Eigen::Matrix3d::Identity()).norm();
}

TEST(MetricUpgrade, UndoesTheDistortionUpToARotationAndTheMirror) {
  for (const int views : {2, 3, 4}) {
    const AffineCapture capture = Distort(views);
    ASSERT_GT(Shear(capture.affine, Eigen::Matrix3d::Identity()), 0.5);
    const std::optional<Eigen::Matrix3d> found = MetricUpgrade(capture.views, capture.joints, capture.skeleton);
    ASSERT_TRUE(found.has_value()) << views;
    EXPECT_LT(Shear(capture.affine, *found), 1e-3) << views;
    EXPECT_EQ((*found)(0, 1), 0.0);  // lower triangular
    EXPECT_EQ((*found)(0, 2), 0.0);
    EXPECT_EQ((*found)(1, 2), 0.0);
  }
}

TEST(MetricUpgrade, IgnoresUnknownViewsAndJoints) {
  AffineCapture capture = Distort(4);
  capture.views[2].setConstant(std::nan(""));
  for (std::size_t i = 0; i < capture.joints.size(); i += 5) capture.joints[i].setConstant(std::nan(""));
  const std::optional<Eigen::Matrix3d> found = MetricUpgrade(capture.views, capture.joints, capture.skeleton);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(Shear(capture.affine, *found), 1e-3);
}

TEST(MetricUpgrade, OfNothingIsNothing) {
  AffineCapture capture = Distort(4);
  for (Eigen::Vector3d& joint : capture.joints) joint.setConstant(std::nan(""));
  EXPECT_FALSE(MetricUpgrade(capture.views, capture.joints, capture.skeleton).has_value());
}

}  // namespace
}  // namespace canonpose
