#include "canonpose/geometry/triangulation.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/median.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/camera_testing.h"

namespace canonpose {
namespace {

using testing::CameraAround;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

TEST(TriangulationTest, APointBehindACameraIsReported) {
  const Camera a = CameraAround(0.0, 1000.0);
  const Camera b = CameraAround(0.0, 1000.0);
  Camera beside = b;
  beside.camera_from_world_translation.x() = -500.0;
  // Rays that diverge in front of the cameras meet behind them.
  const std::vector<PointObservation> observations = {{&a, {400.0, 480.0}, 1.0}, {&beside, {600.0, 480.0}, 1.0}};
  const TriangulatedPoint found = Triangulate(observations);
  ASSERT_TRUE(found.valid());
  EXPECT_FALSE(found.in_front_of_all_cameras);
}

TEST(TriangulationTest, ConfidencePullsTowardsTheViewsThatAreMoreCertain) {
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

/// Rays of cameras around the origin to a point, with normal noise of the given size in millimetres.
std::vector<PointRay> RaysTo(const Eigen::Vector3d& point, int count, double noise, Rng& rng) {
  std::vector<PointRay> rays;
  for (int i = 0; i < count; ++i) {
    const Camera camera = CameraAround(2.0 * i, 4000.0);
    const Eigen::Vector3d in_camera = camera.InCamera(point);
    const Eigen::Vector2d off = noise * Eigen::Vector2d(rng.Normal(), rng.Normal());
    rays.push_back({camera.camera_from_world_rotation, camera.camera_from_world_translation,
                    (in_camera.head<2>() + off) / in_camera.z(), std::max(noise, 1.0)});
  }
  return rays;
}

TEST(TriangulateRobustly, ExactRaysGiveThePoint) {
  Rng rng(7);
  const Eigen::Vector3d point(300.0, -700.0, 200.0);
  for (int count = 2; count < 5; ++count) {
    EXPECT_LT((TriangulateRobustly(RaysTo(point, count, 0.0, rng)).point - point).norm(), 1e-6) << count;
  }
  EXPECT_FALSE(TriangulateRobustly(RaysTo(point, 1, 0.0, rng)).point.allFinite());
  EXPECT_FALSE(TriangulateRobustly({}).point.allFinite());
}

TEST(TriangulateRobustly, ABadViewCountsLittle) {
  Rng rng(8);
  const Eigen::Vector3d point(300.0, -700.0, 200.0);
  std::vector<PointRay> rays = RaysTo(point, 5, 5.0, rng);
  const double good = (TriangulateRobustly(rays).point - point).norm();
  rays[2].direction += Eigen::Vector2d(0.2, 0.0);  // 800 mm at the point
  EXPECT_LT((TriangulateRobustly(rays).point - point).norm(), good + 5.0);
}

TEST(TriangulateRobustly, InformationIsTheInverseOfTheScatterOfPoints) {
  Rng rng(9);
  const Eigen::Vector3d point(300.0, -700.0, 200.0);
  constexpr int kTrials = 4000;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kTrials; ++i) {
    const RobustPoint found = TriangulateRobustly(RaysTo(point, 3, 5.0, rng));
    covariance += (found.point - point) * (found.point - point).transpose() / kTrials;
    expected += found.information.inverse() / kTrials;
  }
  // Reweighting treats some residuals as outliers, so the information is a little too small.
  EXPECT_LT(covariance.trace(), expected.trace());
  EXPECT_GT(covariance.trace(), 0.6 * expected.trace());
  EXPECT_LT((covariance / covariance.trace() - expected / expected.trace()).norm(), 0.05);
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

TEST(TriangulationTest, ReproducesTheReferenceOfTheRealRecording) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing/reference3d.json");
  // The joints of the reference that are keypoints of BODY_25B, with their indices there.
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
