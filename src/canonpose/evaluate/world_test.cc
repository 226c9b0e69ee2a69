#include "canonpose/evaluate/world.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/evaluate/camera_alignment.h"

namespace canonpose {
namespace {

Camera CameraAt(const Eigen::Vector3d& centre, double turn_rad) {
  Camera camera;
  camera.camera_from_world_rotation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(0.1, 1.0, 0.3).normalized()).matrix();
  camera.camera_from_world_translation = -camera.camera_from_world_rotation * centre;
  return camera;
}

/// Four joints over three frames that move through the world, before three calibrated cameras, solved exactly in
/// another frame: x_solved = scale * rotation * x + translation.
struct Recording {
  Dataset dataset;
  std::vector<SequencePoses> truth;

  explicit Recording(double scale, double error_mm = 0.0) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
    const Eigen::Vector3d translation(100.0, -50.0, 70.0);
    dataset.skeleton = {"", {"root", "a", "b", "c"}, {-1, 0, 0, 0}, 0, {0, 1, 2, 3}};
    Sequence& sequence = dataset.sequences.emplace_back();
    sequence.name = "clip";
    sequence.capture = "room";
    sequence.frame_count = 3;
    truth.emplace_back();
    for (int c = 0; c < 3; ++c) {
      CameraView& view = sequence.cameras.emplace_back();
      view.name = "cam" + std::to_string(c);
      view.image_size = {1000, 1000};
      view.calibration = {CameraAt({1000.0 * c, 400.0 * c * c, -3000.0}, 0.3 * c)};
      Camera solved = view.calibration[0];
      solved.camera_from_world_rotation *= rotation.transpose();
      solved.camera_from_world_translation =
          scale * solved.camera_from_world_translation - solved.camera_from_world_rotation * translation;
      view.solved_calibration = {solved};
      std::vector<float> true_positions;
      std::vector<float> positions;
      for (int t = 0; t < 3; ++t) {
        for (int j = 0; j < 4; ++j) {
          const Eigen::Vector3d in_world(500.0 * t + 100.0 * j, 300.0 * (j % 2) + 20.0 * t,
                                         200.0 * static_cast<double>(j / 2));
          // Each pose as a whole is off along z, to one side and the other.
          const Eigen::Vector3d found = in_world + Eigen::Vector3d(0, 0, t == 1 ? -2.0 * error_mm : error_mm);
          const Eigen::Vector3d true_in_camera = view.calibration[0].InCamera(in_world);
          const Eigen::Vector3d in_camera = solved.InCamera(scale * rotation * found + translation);
          for (int axis = 0; axis < 3; ++axis) {
            true_positions.push_back(static_cast<float>(true_in_camera[axis]));
            positions.push_back(static_cast<float>(in_camera[axis]));
          }
        }
      }
      const LengthUnit unit = scale == 1.0 ? LengthUnit::kMillimetres : LengthUnit::kBodyLengths;
      view.solved = PosesInCamera(dataset.skeleton, positions, unit, view.name);
      truth[0].poses_in_camera.push_back(TruthPoses(dataset.skeleton, true_positions, view.name));
    }
  }

  [[nodiscard]] WorldErrors Compare(std::vector<int> left_out = {}) const {
    WorldComparison comparison(std::move(left_out));
    comparison.Add(dataset, truth);
    return comparison.Means().value();
  }
};

TEST(WorldComparison, ASimilarityOfTheWholeRecordingIsNoError) {
  const WorldErrors errors = Recording(0.01).Compare();
  EXPECT_NEAR(errors.wa_mpjpe_mm, 0.0, 0.01);
  EXPECT_NEAR(errors.pa_mpjpe_mm, 0.0, 0.01);
  EXPECT_FALSE(errors.w_mpjpe_mm) << "without a unit there is no error without scale";
  EXPECT_NEAR(Recording(1.0).Compare().w_mpjpe_mm.value(), 0.0, 0.01);
}

TEST(WorldComparison, CountsWherePosesAreAndNotOnlyTheirShape) {
  const WorldErrors errors = Recording(1.0, 30.0).Compare();
  EXPECT_NEAR(errors.pa_mpjpe_mm, 0.0, 0.01);
  // 30, 60 and 30 mm with cameras aligned; a similarity of all can only make it a little better.
  EXPECT_NEAR(errors.w_mpjpe_mm.value(), 40.0, 0.1);
  EXPECT_NEAR(errors.wa_mpjpe_mm, 40.0, 3.0);
}

TEST(WorldComparison, ScaleCountsOnlyWithoutASimilarity) {
  Recording recording(1.0);
  for (CameraView& view : recording.dataset.sequences[0].cameras) {
    for (float& coordinate : view.solved.positions()) coordinate *= 1.1F;
    view.solved_calibration[0].camera_from_world_translation *= 1.1;
  }
  const WorldErrors errors = recording.Compare();
  EXPECT_NEAR(errors.wa_mpjpe_mm, 0.0, 0.01);
  EXPECT_GT(errors.w_mpjpe_mm.value(), 50.0);
}

TEST(WorldComparison, WithoutCalibrationOneCamerasFrameIsTheWorld) {
  Recording recording(0.01, 30.0);
  for (CameraView& view : recording.dataset.sequences[0].cameras) view.calibration.clear();
  EXPECT_NEAR(recording.Compare().wa_mpjpe_mm, 40.0, 3.0);
}

TEST(WorldComparison, LeavesJointsOut) {
  Recording recording(1.0);
  for (CameraView& view : recording.dataset.sequences[0].cameras) {
    for (int t = 0; t < 3; ++t) view.solved.PoseAt(t).row(3).array() += 500.0F;
  }
  EXPECT_GT(recording.Compare().w_mpjpe_mm.value(), 100.0);
  EXPECT_NEAR(recording.Compare({3}).w_mpjpe_mm.value(), 0.0, 0.01);
}

TEST(WorldComparison, MovingCamerasHaveNoWorld) {
  Recording recording(1.0);
  recording.dataset.sequences[0].static_cameras = false;
  WorldComparison comparison;
  comparison.Add(recording.dataset, recording.truth);
  EXPECT_FALSE(comparison.Means());
}

TEST(CameraPairs, TwoCamerasAreAlignedByTheirAxes) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  CameraPairs pairs;
  for (int c = 0; c < 2; ++c) {
    const Camera truth = CameraAt({1000.0 * c, 0.0, 0.0}, 0.3 * c);
    Camera solved = truth;
    solved.camera_from_world_rotation *= rotation.transpose();
    pairs.Add(solved, truth);
  }
  const Similarity rigid = pairs.Rigid();
  EXPECT_LT((rigid.rotation * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(rigid.scale, 1.0);
  EXPECT_NEAR(pairs.MeanDistance(rigid), 0.0, 1e-9);
}

}  // namespace
}  // namespace canonpose
