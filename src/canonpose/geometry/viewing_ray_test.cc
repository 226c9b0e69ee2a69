#include "canonpose/geometry/viewing_ray.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

constexpr int kJoints = 5;

/// A body around a root, in mm.
std::vector<Eigen::Vector3d> Body() {
  return {{0, 0, 0}, {150, -400, 80}, {-200, 300, -120}, {90, 650, 200}, {-60, -500, -250}};
}

std::vector<float> Filmed(const std::vector<Eigen::Vector3d>& in_camera, const Pinhole& pinhole) {
  std::vector<float> pixels;
  for (const Eigen::Vector3d& point : in_camera) {
    const Eigen::Vector2d pixel = pinhole.principal_point_px + pinhole.focal_px.cwiseProduct(point.hnormalized());
    pixels.push_back(static_cast<float>(pixel.x()));
    pixels.push_back(static_cast<float>(pixel.y()));
  }
  return pixels;
}

TEST(RotationOntoAxis, IsTheSmallestRotationThatTakesTheRayToTheAxis) {
  for (const Eigen::Vector3d& ray :
       {Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0.5, -0.3, 1), Eigen::Vector3d(-3, 1, 1)}) {
    const Eigen::Matrix3d rotation = RotationOntoAxis(ray);
    EXPECT_NEAR((rotation * ray.normalized() - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12);
    EXPECT_NEAR((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
    EXPECT_NEAR(rotation.determinant(), 1.0, 1e-12);
    const double angle = std::acos(ray.normalized().z());
    EXPECT_NEAR(Eigen::AngleAxisd(rotation).angle(), angle, 1e-9);
  }
}

TEST(NormalisePoseOnAxis, SeesWhatACameraOnTheAxisSees) {
  const std::vector<float> confidence(kJoints, 0.8F);
  const Pinhole pinhole{{1200, 1150}, {510, 480}};
  // The same body on the axis, and rotated about the camera's centre to the border of the image.
  const Eigen::Vector3d on_axis(0, 0, 3000);
  const Eigen::Vector3d beside(1400, -900, 2500);
  const Eigen::Matrix3d camera_from_turned = RotationOntoAxis(beside).transpose();
  std::vector<Eigen::Vector3d> straight;
  std::vector<Eigen::Vector3d> aslant;
  for (const Eigen::Vector3d& point : Body()) {
    straight.push_back(point + on_axis);
    aslant.push_back(camera_from_turned * straight.back());
  }
  NormalisedPose expected;
  ASSERT_TRUE(NormalisePose(Filmed(straight, pinhole).data(), confidence.data(), kJoints, 0, expected));
  NormalisedPose pose;
  Eigen::Matrix3d turned_from_camera;
  const std::vector<float> pixels = Filmed(aslant, pinhole);
  ASSERT_TRUE(NormalisePoseOnAxis(pixels.data(), confidence.data(), kJoints, 0, pinhole, pose, turned_from_camera));
  for (std::size_t i = 0; i < pose.keypoints.size(); ++i) {
    EXPECT_NEAR(pose.keypoints[i], expected.keypoints[i], 1e-5);
  }
  EXPECT_EQ(pose.confidence, expected.confidence);
  EXPECT_NEAR((turned_from_camera * camera_from_turned - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-6);
  // Without the rotation it looks different.
  NormalisedPose seen_aslant;
  ASSERT_TRUE(NormalisePose(pixels.data(), confidence.data(), kJoints, 0, seen_aslant));
  EXPECT_GT(std::abs(seen_aslant.keypoints[3] - expected.keypoints[3]), 0.01);
}

TEST(NormalisePoseOnAxis, WithoutAKnownCameraNothingIsTurned) {
  const std::vector<float> confidence(kJoints, 1.0F);
  std::vector<Eigen::Vector3d> points = Body();
  for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(500, 400, 3000);
  const std::vector<float> pixels = Filmed(points, {{1000, 1000}, {0, 0}});
  NormalisedPose plain;
  NormalisedPose pose;
  Eigen::Matrix3d turned_from_camera;
  ASSERT_TRUE(NormalisePose(pixels.data(), confidence.data(), kJoints, 0, plain));
  ASSERT_TRUE(NormalisePoseOnAxis(pixels.data(), confidence.data(), kJoints, 0, Pinhole::Guess({0, 0}), pose,
                                  turned_from_camera));
  EXPECT_EQ(pose.keypoints, plain.keypoints);
  EXPECT_EQ(turned_from_camera, Eigen::Matrix3d::Identity());
}

TEST(NormalisePoseOnAxis, MissingJointsStayMissingAndAMissingRootIsRefused) {
  std::vector<float> confidence(kJoints, 1.0F);
  std::vector<Eigen::Vector3d> points = Body();
  for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(500, 400, 3000);
  const Pinhole pinhole = Pinhole::Guess({1000, 800});
  EXPECT_NEAR(pinhole.focal_px.x(), std::sqrt(1000.0 * 1000.0 + 800.0 * 800.0), 1e-9);
  std::vector<float> pixels = Filmed(points, pinhole);
  confidence[3] = 0.0F;
  pixels[4] = std::numeric_limits<float>::quiet_NaN();
  NormalisedPose pose;
  Eigen::Matrix3d turned_from_camera;
  ASSERT_TRUE(NormalisePoseOnAxis(pixels.data(), confidence.data(), kJoints, 0, pinhole, pose, turned_from_camera));
  EXPECT_EQ(pose.confidence, (std::vector<float>{1, 1, 0, 0, 1}));
  EXPECT_EQ(pose.keypoints[2], 0.0F);
  confidence[0] = 0.0F;
  EXPECT_FALSE(NormalisePoseOnAxis(pixels.data(), confidence.data(), kJoints, 0, pinhole, pose, turned_from_camera));
}

}  // namespace
}  // namespace canonpose
