#include "canonpose/train/new_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/geometry/angles.h"
#include "canonpose/train/augmentation.h"

namespace canonpose {
namespace {

constexpr int kFilmedJoints = 17;
constexpr int kFrames = 6;

/// Level cameras around a scene whose down is (0, 1, 0), then rotated as a whole: x_in_camera = R x_in_world.
std::vector<Eigen::Matrix3d> Around(const std::vector<double>& azimuths, const Eigen::Matrix3d& scene_from_world,
                                    double tilt = 0.3) {
  std::vector<Eigen::Matrix3d> rotations;
  for (const double azimuth : azimuths) {
    rotations.push_back(
        (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitY()))
            .toRotationMatrix() *
        scene_from_world);
  }
  return rotations;
}

/// Random bodies in front of level, calibrated cameras. The keypoints are off by `noise` of the body's size.
Dataset Filmed(double noise) {
  Rng rng(4);
  Dataset dataset;
  dataset.skeleton = *FindSkeleton("h36m-17");
  Sequence sequence{"s", "s", 30.0, true, "s", kFrames, {}};
  const Eigen::Matrix3d scene_from_world =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& rotation : Around({0.0, 1.5, 3.5}, scene_from_world)) {
    CameraView view;
    view.name = "cam" + std::to_string(sequence.cameras.size());
    view.image_size = {1000, 900};
    Camera camera;
    camera.K << 1100, 0, 500, 0, 1100, 450, 0, 0, 1;
    camera.distortion = {-0.1, 0.02, 0.001, 0.0};
    camera.camera_from_world_rotation = rotation;
    view.calibration = {camera};
    std::vector<float> truth;
    for (int t = 0; t < kFrames; ++t) {
      const Eigen::Vector3d root(rng.Uniform(-800, 800), rng.Uniform(-500, 500), rng.Uniform(3500, 5000));
      for (int j = 0; j < kFilmedJoints; ++j) {
        Eigen::Vector3d point = root;
        if (j != dataset.skeleton.root) point += 400.0 * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
        for (const double value : point) truth.push_back(static_cast<float>(value));
        const Eigen::Vector2d pixel =
            camera.ProjectFromCamera(point) + 100.0 * noise * Eigen::Vector2d(rng.Normal(), rng.Normal());
        view.keypoints.push_back(static_cast<float>(pixel.x()));
        view.keypoints.push_back(static_cast<float>(pixel.y()));
        view.confidence.push_back(static_cast<float>(rng.Uniform(0.3, 1.0)));
      }
    }
    view.truth = TruthPoses(dataset.skeleton, std::move(truth), view.name);
    sequence.cameras.push_back(view);
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

RowForm Form(RayForm ray, FocalSource focal = FocalSource::kKnown) {
  return {TrainingTarget::kTruth, {ray, focal}, false};
}

/// A row's copy in a batch.
struct Copy {
  explicit Copy(const TrainingSet& set, int row) {
    keypoints.assign(set.keypoints.begin() + 2L * kFilmedJoints * row,
                     set.keypoints.begin() + 2L * kFilmedJoints * (row + 1));
    confidence.assign(set.confidence.begin() + 1L * kFilmedJoints * row,
                      set.confidence.begin() + 1L * kFilmedJoints * (row + 1));
    target.assign(set.target.begin() + 3L * kFilmedJoints * row, set.target.begin() + 3L * kFilmedJoints * (row + 1));
  }
  TrainingRow row() { return {keypoints.data(), confidence.data(), target.data(), nullptr}; }
  std::vector<float> keypoints;
  std::vector<float> confidence;
  std::vector<float> target;
};

TEST(EstimateDown, IsTheVerticalOfLevelCamerasAndUnknownForParallelOnes) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  const Eigen::Vector3d expected = turn.transpose() * Eigen::Vector3d::UnitY();
  for (const double tilt : {0.0, 0.4, -0.4}) {
    const auto down = EstimateDown(Around({0.0, 0.6, 2.9}, turn, tilt));
    ASSERT_TRUE(down.has_value());
    EXPECT_NEAR((*down - expected).norm(), 0.0, 1e-9);
  }
  EXPECT_TRUE(EstimateDown(Around({0.2, 0.8}, turn)).has_value());
  EXPECT_FALSE(EstimateDown(Around({0.2, 0.3}, turn)).has_value());
  EXPECT_FALSE(EstimateDown(Around({0.2, 0.2 + std::numbers::pi}, turn)).has_value());
  EXPECT_FALSE(EstimateDown(Around({0.2}, turn)).has_value());
  EXPECT_FALSE(EstimateDown({}).has_value());
}

TEST(NewViews, ThePoseFromItsOwnPlaceIsTheRowItself) {
  for (const RowForm& form : {Form(RayForm::kOff), Form(RayForm::kRoot), Form(RayForm::kRoot, FocalSource::kGuess)}) {
    const Dataset dataset = Filmed(0.05);
    const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, form);
    const NewViews views({dataset}, split.training, form);
    ASSERT_TRUE(views.any());
    for (int row = 0; row < split.training.row_count(); ++row) {
      const Copy before(split.training, row);
      Copy after = before;
      NewCamera same;
      same.place = row;
      ASSERT_TRUE(views.See(row, same, after.row()));
      for (std::size_t i = 0; i < before.keypoints.size(); ++i)
        EXPECT_NEAR(after.keypoints[i], before.keypoints[i], 1e-4);
      for (std::size_t i = 0; i < before.target.size(); ++i) EXPECT_NEAR(after.target[i], before.target[i], 1e-5);
      EXPECT_EQ(after.confidence, before.confidence);
    }
  }
}

/// The pose of `target` (planar) set down at `distance` (in its own unit) on the axis, seen there, normalised.
NormalisedPose SeenOnAxis(const std::vector<float>& target, double distance, const std::vector<float>& confidence,
                          int root) {
  std::vector<float> pixels;
  for (std::size_t j = 0; j < kFilmedJoints; ++j) {
    const double depth = distance + target[2 * kFilmedJoints + j];
    pixels.push_back(static_cast<float>(target[j] / depth));
    pixels.push_back(static_cast<float>(target[kFilmedJoints + j] / depth));
  }
  NormalisedPose pose;
  EXPECT_TRUE(NormalisePose(pixels.data(), confidence.data(), kFilmedJoints, root, pose));
  return pose;
}

TEST(NewViews, WithoutDetectorErrorsTheNewKeypointsAreTheProjectionOfTheNewPose) {
  Dataset dataset = Filmed(0.0);
  for (CameraView& view : dataset.sequences[0].cameras)
    view.confidence[kFilmedJoints * 2 + 3] = 0.0F;  // frame 2 lacks a joint
  const RowForm form = Form(RayForm::kRoot);
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, form);
  // The lens is known, but the rotation of the input ignores distortion.
  for (CameraView& view : dataset.sequences[0].cameras) {
    for (Camera& camera : view.calibration) camera.distortion = {0, 0, 0, 0};
    for (std::size_t i = 0; i < view.confidence.size(); ++i) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        view.keypoints[2 * i + axis] =
            1100 * view.truth.positions()[3 * i + axis] / view.truth.positions()[3 * i + 2] + (axis == 0 ? 500 : 450);
      }
    }
  }
  const NewViews views({dataset}, split.training, form);
  Rng rng(9);
  int missing = 0;
  double largest_turn = 0.0;
  for (int draw = 0; draw < 200; ++draw) {
    const int row = static_cast<int>(rng.Index(static_cast<std::size_t>(split.training.row_count())));
    const Copy before(split.training, row);
    Copy after = before;
    const NewCamera camera = views.Draw(row, rng);
    ASSERT_TRUE(views.See(row, camera, after.row()));
    const RowSource& source = split.training.sources[static_cast<std::size_t>(row)];
    const CameraView& view = dataset.sequences[0].cameras[static_cast<std::size_t>(source.camera)];
    const float* truth = &view.truth.positions()[static_cast<std::size_t>(source.frame) * kFilmedJoints * 3];
    const int root = dataset.skeleton.root;
    Eigen::Vector3d root_mm(truth[3 * root], truth[3 * root + 1], truth[3 * root + 2]);
    double squares = 0.0;
    for (int j = 0; j < kFilmedJoints; ++j) {
      squares += (Eigen::Vector3d(truth[3 * j], truth[3 * j + 1], truth[3 * j + 2]) - root_mm).squaredNorm();
    }
    const double distance = camera.distance_factor * root_mm.norm() / std::sqrt(squares);
    const NormalisedPose expected = SeenOnAxis(after.target, distance, after.confidence, root);
    for (std::size_t i = 0; i < after.keypoints.size(); ++i)
      EXPECT_NEAR(after.keypoints[i], expected.keypoints[i], 1e-4);
    missing += static_cast<int>(std::count(after.confidence.begin(), after.confidence.end(), 0.0F));
    for (std::size_t i = 0; i < after.target.size(); ++i) {
      largest_turn = std::max(largest_turn, std::abs(static_cast<double>(after.target[i]) - before.target[i]));
    }
  }
  EXPECT_GT(largest_turn, 0.3);
  EXPECT_GT(missing, 10);  // one in six has the place of a pose without the joint
}

TEST(NewViews, CamerasTurnAboutTheVerticalAndKeepTheirTilt) {
  const Dataset dataset = Filmed(0.0);
  const RowForm form = Form(RayForm::kOff);
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, form);
  const NewViews views({dataset}, split.training, form);
  const Eigen::Vector3d down =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix() * Eigen::Vector3d::UnitY();
  Rng rng(2);
  constexpr int kDraws = 2000;
  double squares_rad2 = 0.0;
  double squares_log = 0.0;
  std::vector<int> quarters(4, 0);
  for (int i = 0; i < kDraws; ++i) {
    const NewCamera camera = views.Draw(i % split.training.row_count(), rng);
    const double angle_rad = std::acos(std::min(1.0, down.dot(camera.rotation * down)));
    squares_rad2 += angle_rad * angle_rad / kDraws;
    squares_log += std::pow(std::log(camera.distance_factor), 2) / kDraws;
    const Eigen::Vector3d side = camera.rotation * Eigen::Vector3d::UnitX();
    const double yaw = std::atan2(down.cross(Eigen::Vector3d::UnitX()).dot(side), side.x());
    ++quarters[static_cast<std::size_t>(std::clamp(2.0 + yaw * 2.0 / std::numbers::pi, 0.0, 3.9))];
  }
  // Tilt and roll both move the vertical, roll a little less: the cameras look down by 0.3.
  const double expected_deg = 5.0 * std::sqrt(1.0 + std::pow(std::cos(0.3), 2));
  EXPECT_NEAR(DegFromRad(std::sqrt(squares_rad2)), expected_deg, 0.3);
  EXPECT_NEAR(std::sqrt(squares_log), 0.15, 0.01);
  for (const int quarter : quarters) EXPECT_NEAR(quarter, kDraws / 4.0, kDraws / 20.0);
}

TEST(NewViews, RowsWithoutACameraStayAsTheyAre) {
  Dataset dataset = Filmed(0.0);
  dataset.sequences[0].cameras[1].calibration.clear();
  const RowForm form = Form(RayForm::kOff);
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, form);
  const NewViews views({dataset}, split.training, form);
  const Copy before(split.training, 1);
  Copy after = before;
  ASSERT_EQ(split.training.sources[1].camera, 1);
  Rng rng(3);
  EXPECT_FALSE(views.See(1, views.Draw(1, rng), after.row()));
  EXPECT_EQ(after.keypoints, before.keypoints);
  EXPECT_EQ(after.target, before.target);
  EXPECT_TRUE(views.See(0, views.Draw(0, rng), after.row()));
}

}  // namespace
}  // namespace canonpose
