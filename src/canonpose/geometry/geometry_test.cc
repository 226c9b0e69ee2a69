#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/geometry/camera.h"
#include "canonpose/geometry/triangulation.h"

namespace canonpose {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A camera `distance_mm` from the origin at the given bearing, looking at it.
Camera CameraAround(double bearing_rad, double distance_mm) {
  Camera camera;
  camera.K << 1100.0, 0.0, 500.0, 0.0, 1100.0, 480.0, 0.0, 0.0, 1.0;
  camera.camera_from_world_rotation = Eigen::AngleAxisd(bearing_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.camera_from_world_translation = {0.0, 0.0, distance_mm};
  camera.distortion = {-0.05, 0.12, 0.001, -0.0007};
  return camera;
}

Points3d RandomPoints(Rng& rng, int count) {
  Points3d points(count, 3);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = rng.Normal();
  return points;
}

Eigen::Matrix3d RandomRotation(Rng& rng) {
  return Eigen::Quaterniond(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()).normalized().toRotationMatrix();
}

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

TEST(AlignmentTest, ScaleByHand) {
  Points3d from(2, 3);
  from << 1, 0, 0, 0, 2, 0;
  Points3d to(2, 3);
  to << 3, 1, 0, 0, 1, 0;
  EXPECT_DOUBLE_EQ(LeastSquaresScale(from, to), (3.0 + 2.0) / 5.0);
  EXPECT_EQ(LeastSquaresScale(Points3d::Zero(2, 3), to), 0.0);
}

TEST(AlignmentTest, FindsTheSimilarityThatMadeThePoints) {
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const Points3d from = RandomPoints(rng, 3 + i % 15);
    Similarity truth;
    truth.scale = rng.Uniform(0.1, 10.0);
    truth.rotation = RandomRotation(rng);
    truth.translation = {rng.Normal(), rng.Normal(), 100.0};
    const Similarity found = AlignSimilarity(from, truth.Apply(from));
    EXPECT_NEAR(found.scale, truth.scale, 1e-9);
    EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-7);
    EXPECT_LT((found.Apply(from) - truth.Apply(from)).norm(), 1e-8);
  }
}

TEST(AlignmentTest, IsTheBestOfItsNeighbours) {
  Rng rng(3);
  const Points3d from = RandomPoints(rng, 12);
  const Points3d to = RandomPoints(rng, 12);
  const Similarity best = AlignSimilarity(from, to);
  const double least = (best.Apply(from) - to).squaredNorm();
  for (int i = 0; i < 200; ++i) {
    Similarity other = best;
    const Eigen::Vector3d axis = Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()).normalized();
    other.rotation = Eigen::AngleAxisd(0.05 * rng.Normal(), axis).toRotationMatrix() * best.rotation;
    other.scale *= 1.0 + 0.05 * rng.Normal();
    other.translation += 0.05 * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
    EXPECT_GE((other.Apply(from) - to).squaredNorm(), least);
  }
}

TEST(AlignmentTest, NeverReflects) {
  Rng rng(4);
  const Points3d from = RandomPoints(rng, 17);
  Points3d mirrored = from;
  mirrored.col(2) *= -1.0;
  const Similarity found = AlignSimilarity(from, mirrored);
  EXPECT_NEAR(found.rotation.determinant(), 1.0, 1e-9);
  EXPECT_GT((found.Apply(from) - mirrored).rowwise().norm().mean(), 0.3);
}

TEST(AlignmentTest, PointsThatCoincideGiveTheMean) {
  Rng rng(5);
  const Points3d to = RandomPoints(rng, 4);
  const Similarity found = AlignSimilarity(Points3d::Ones(4, 3), to);
  EXPECT_EQ(found.scale, 0.0);
  EXPECT_LT((found.translation - to.colwise().mean().transpose()).norm(), 1e-12);
}

TEST(AlignmentTest, NearestRotationIsProper) {
  Rng rng(6);
  const Eigen::Matrix3d rotation = RandomRotation(rng);
  EXPECT_LT((NearestRotation(3.0 * rotation) - rotation).norm(), 1e-9);
  EXPECT_NEAR(NearestRotation(-rotation).determinant(), 1.0, 1e-9);
}

TEST(TriangulationTest, ExactPixelsGiveThePoint) {
  const std::vector<Camera> cameras = {CameraAround(0.0, 4000.0), CameraAround(1.2, 5000.0),
                                       CameraAround(-2.0, 3000.0)};
  const Eigen::Vector3d point(300.0, -700.0, 200.0);
  std::vector<PointObservation> observations;
  for (const Camera& camera : cameras) observations.push_back({&camera, camera.Project(point), 0.7});
  TriangulatedPoint found = Triangulate(observations);
  EXPECT_LT((found.point_in_world_mm - point).norm(), 1e-5);
  EXPECT_LT(found.reprojection_error_px, 1e-6);
  EXPECT_EQ(found.view_count, 3);
  EXPECT_TRUE(found.in_front_of_all_cameras);
  EXPECT_NEAR(found.largest_ray_angle_rad, 2.0, 1.3);

  observations[0].confidence = 0.0;
  observations[0].pixel = {kNaN, kNaN};
  found = Triangulate(observations);
  EXPECT_LT((found.point_in_world_mm - point).norm(), 1e-5);
  EXPECT_EQ(found.view_count, 2);
}

TEST(TriangulationTest, OneViewOrTheSameViewTwiceGivesNothing) {
  const Camera camera = CameraAround(0.0, 4000.0);
  std::vector<PointObservation> observations = {{&camera, {510.0, 500.0}, 1.0}};
  EXPECT_FALSE(Triangulate(observations).valid());
  EXPECT_TRUE(std::isnan(Triangulate(observations).reprojection_error_px));
  observations.push_back(observations.front());
  EXPECT_FALSE(Triangulate(observations).valid());
  EXPECT_FALSE(Triangulate({}).valid());
}

TEST(TriangulationTest, APointBehindACameraIsTold) {
  const Camera a = CameraAround(0.0, 1000.0);
  const Camera b = CameraAround(0.0, 1000.0);
  Camera beside = b;
  beside.camera_from_world_translation.x() = -500.0;
  // Rays that part in front of the cameras meet behind them.
  const std::vector<PointObservation> observations = {{&a, {400.0, 480.0}, 1.0}, {&beside, {600.0, 480.0}, 1.0}};
  const TriangulatedPoint found = Triangulate(observations);
  ASSERT_TRUE(found.valid());
  EXPECT_FALSE(found.in_front_of_all_cameras);
}

TEST(TriangulationTest, ConfidencePullsTowardsTheSurerViews) {
  const std::vector<Camera> cameras = {CameraAround(0.0, 4000.0), CameraAround(1.2, 4000.0),
                                       CameraAround(-1.0, 4000.0)};
  const Eigen::Vector3d point(0.0, 100.0, 0.0);
  const auto error_mm = [&](double confidence_of_wrong_view) {
    std::vector<PointObservation> observations;
    for (const Camera& camera : cameras) observations.push_back({&camera, camera.Project(point), 0.9});
    observations[2].pixel += Eigen::Vector2d(60.0, 0.0);
    observations[2].confidence = confidence_of_wrong_view;
    return (Triangulate(observations).point_in_world_mm - point).norm();
  };
  EXPECT_GT(error_mm(0.9), 20.0);
  EXPECT_LT(error_mm(0.09), 0.05 * error_mm(0.9));
}

// ------------------------------------------------------------------------- the real recording beside the checkout

nlohmann::json ReadJson(const std::string& name) {
  std::ifstream stream(testing::Shared("data/balancing/" + name));
  return nlohmann::json::parse(stream);
}

Camera CameraOf(const nlohmann::json& entry) {
  Camera camera;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      camera.K(r, c) = entry["K"][r][c];
      camera.camera_from_world_rotation(r, c) = entry["R"][r][c];
    }
    camera.camera_from_world_translation[r] = entry["t"][r];
    camera.distortion[static_cast<std::size_t>(r)] = entry["distortion"][r];
  }
  camera.distortion[3] = entry["distortion"][3];
  return camera;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(TriangulationTest, ReproducesTheReferenceOfTheRealRecording) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing/reference3d.json");
  // The reference's joints that are keypoints of BODY_25B themselves, with their places there.
  const std::vector<std::pair<std::string, int>> body_25b = {{"lsho", 5},  {"rsho", 6},  {"lelb", 7},   {"relb", 8},
                                                             {"lhip", 11}, {"rhip", 12}, {"lknee", 13}, {"rknee", 14}};
  const nlohmann::json reference = ReadJson("reference3d.json");
  const nlohmann::json calibration = ReadJson("calibration.json")["cameras"];
  std::vector<Camera> cameras;
  std::vector<std::string> names;
  for (const auto& [name, entry] : calibration.items()) {
    names.push_back(name);
    cameras.push_back(CameraOf(entry));
  }
  const std::vector<std::string> joints = reference["joints"];
  std::vector<double> distances_mm;
  std::vector<double> reprojections_px;
  for (std::size_t frame = 0; frame < reference["pose3d"].size(); ++frame) {
    std::vector<std::vector<float>> keypoints;
    for (const std::string& name : names) {
      const nlohmann::json people = ReadJson(fmt::format("{}/{}.{:04}.json", name, name, frame))["people"];
      keypoints.push_back(people.empty() ? std::vector<float>(75, 0.0F)
                                         : people[0]["pose_keypoints_2d"].get<std::vector<float>>());
    }
    for (const auto& [joint, place] : body_25b) {
      const auto k = static_cast<std::size_t>(3 * place);
      std::vector<PointObservation> observations;
      for (std::size_t v = 0; v < cameras.size(); ++v) {
        observations.push_back({&cameras[v], {keypoints[v][k], keypoints[v][k + 1]}, keypoints[v][k + 2]});
      }
      const TriangulatedPoint found = Triangulate(observations);
      const auto row = static_cast<std::size_t>(std::find(joints.begin(), joints.end(), joint) - joints.begin());
      ASSERT_LT(row, joints.size()) << joint;
      const std::vector<double> expected = reference["pose3d"][frame][row];
      distances_mm.push_back((found.point_in_world_mm - Eigen::Vector3d(expected.data())).norm());
      reprojections_px.push_back(found.reprojection_error_px);
    }
  }
  EXPECT_LT(Median(distances_mm), 0.05);
  EXPECT_NEAR(Median(reprojections_px), reference["median_reprojection_error_px"].get<double>(), 3.0);
}

}  // namespace
}  // namespace canonpose
