#include "canonpose/geometry/camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/geometry/camera_testing.h"

namespace canonpose {
namespace {

using testing::CameraAround;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(CameraTest, ProjectsByHand) {
  Camera camera;
  camera.K << 1000.0, 0.0, 500.0, 0.0, 1000.0, 400.0, 0.0, 0.0, 1.0;
  camera.camera_from_world_translation = {0.0, 0.0, 1000.0};
  EXPECT_TRUE(camera.Project({100.0, -200.0, 1000.0}).isApprox(Eigen::Vector2d(550.0, 300.0)));
  EXPECT_TRUE(std::isnan(camera.Project({100.0, -200.0, -1000.5}).x())) << "a point behind the camera has no pixel";
}

TEST(CameraTest, DistortsByHand) {
  // r^2 = 0.05; radial = 1 + 0.1 * 0.05 + 0.2 * 0.0025 = 1.0055.
  const Eigen::Vector2d distorted = Distort({0.1, 0.2}, {0.1, 0.2, 0.01, 0.02});
  EXPECT_NEAR(distorted.x(), 0.1 * 1.0055 + 2 * 0.01 * 0.02 + 0.02 * (0.05 + 0.02), 1e-15);
  EXPECT_NEAR(distorted.y(), 0.2 * 1.0055 + 0.01 * (0.05 + 0.08) + 2 * 0.02 * 0.02, 1e-15);
}

TEST(CameraTest, UndistortUndoesProject) {
  const Camera camera = CameraAround(0.3, 4000.0);
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d point(rng.Uniform(-1000, 1000), rng.Uniform(-1000, 1000), rng.Uniform(-1000, 1000));
    const Eigen::Vector3d in_camera = camera.InCamera(point);
    const Eigen::Vector2d normalised = camera.Undistort(camera.Project(point));
    EXPECT_LT((normalised - in_camera.head<2>() / in_camera.z()).norm(), 1e-11);
  }
  EXPECT_TRUE(std::isnan(camera.Undistort({kNaN, 3.0}).x()));
}

TEST(CameraTest, UndistortIsNaNWhereDistortionHasNoInverse) {
  Camera camera;
  camera.distortion = {-1.0, 0.0, 0.0, 0.0};  // r - r^3 never exceeds 0.385
  EXPECT_TRUE(std::isnan(camera.Undistort({0.5, 0.0}).x()));
  EXPECT_TRUE(camera.Undistort({0.3, 0.0}).allFinite());
}

TEST(CameraTest, ThirdRadialCoefficient) {
  EXPECT_NEAR(Distort({0.5, 0.0}, {0.1, 0.2, 0.0, 0.0, 0.4}).x(), 0.5 * (1 + 0.1 / 4 + 0.2 / 16 + 0.4 / 64), 1e-15);
  Camera camera;
  camera.distortion = {-0.2, 0.3, 0.001, 0.002, -0.15};
  const Eigen::Vector2d seen = camera.Project({300.0, -400.0, 1000.0});
  EXPECT_LT((camera.Undistort(seen) - Eigen::Vector2d(0.3, -0.4)).norm(), 1e-9);
  // r (1 - 0.2 u + 0.3 u^2 - 0.15 u^3) turns back where 1 - 0.6 u + 1.5 u^2 - 1.05 u^3 is 0, at r = 1.2157.
  EXPECT_TRUE(camera.Project({1200.0, 0.0, 1000.0}).allFinite());
  EXPECT_TRUE(std::isnan(camera.Project({1220.0, 0.0, 1000.0}).x()));
}

}  // namespace
}  // namespace canonpose
