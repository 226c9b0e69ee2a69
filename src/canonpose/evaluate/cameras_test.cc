#include "canonpose/evaluate/cameras.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

Camera CameraOf(double focal_px, double turn_rad) {
  Camera camera;
  camera.K(0, 0) = camera.K(1, 1) = focal_px;
  camera.camera_from_world_rotation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return camera;
}

Dataset TwoCameras() {
  Sequence sequence{"walk", "S1", 50.0, true, "room", 3, {}};
  for (const double turn : {0.0, 1.0}) {
    CameraView view;
    view.calibration = {CameraOf(1000.0, turn)};
    sequence.cameras.push_back(view);
  }
  Dataset dataset;
  dataset.sequences = {sequence};
  return dataset;
}

TEST(CameraComparisonTest, OnlyRelativeRotationsCount) {
  Dataset dataset = TwoCameras();
  const Eigen::Matrix3d other_world = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (CameraView& view : dataset.sequences[0].cameras) {
    view.solved_calibration = {view.calibration[0]};
    view.solved_calibration[0].camera_from_world_rotation *= other_world;
  }
  CameraComparison same;
  same.Add(dataset);
  ASSERT_TRUE(same.Medians());
  EXPECT_NEAR(same.Medians()->relative_rotation_deg, 0.0, 1e-6);
  EXPECT_NEAR(same.Medians()->focal_percent, 0.0, 1e-9);

  dataset.sequences[0].cameras[1].solved_calibration = {CameraOf(1100.0, 1.0 + 0.1)};
  dataset.sequences[0].cameras[0].solved_calibration = {CameraOf(1100.0, 0.0)};
  CameraComparison off;
  off.Add(dataset);
  EXPECT_NEAR(off.Medians()->relative_rotation_deg, DegFromRad(0.1), 1e-6);
  EXPECT_NEAR(off.Medians()->focal_percent, 10.0, 1e-9);
}

TEST(CameraComparisonTest, AnOffCentreLensIsARotatedCamera) {
  Dataset dataset = TwoCameras();
  const double shift_px = 1000.0 * std::tan(0.02);
  for (std::size_t v = 0; v < 2; ++v) {
    CameraView& view = dataset.sequences[0].cameras[v];
    view.solved_calibration = view.calibration;  // uses pixel (0, 0) as the optical axis
    view.calibration[0].K(0, 2) = v == 0 ? 0.0 : shift_px;
    // The true camera's axis is to the right of the solved one.
    if (v == 1)
      view.calibration[0].camera_from_world_rotation = CameraOf(1000.0, 1.0 - 0.02).camera_from_world_rotation;
  }
  CameraComparison comparison;
  comparison.Add(dataset);
  EXPECT_NEAR(comparison.Medians()->relative_rotation_deg, DegFromRad(0.02), 1e-6);
  EXPECT_NEAR(comparison.Medians()->centred_rotation_deg, 0.0, 1e-6);
}

TEST(CameraComparisonTest, FieldsOfViewAreThoseOfTheLenses) {
  Dataset dataset = TwoCameras();
  for (CameraView& view : dataset.sequences[0].cameras) {
    view.image_size = {1600, 1000};
    view.solved_calibration = view.calibration;  // optical axis at pixel (0, 0), focal length 1000 px
    // The edge, at 500 px, is seen by a ray of slope x with x - 0.2 x^3 = 0.5: 0.531...
    view.calibration[0].distortion = {-0.2, 0.0, 0.0, 0.0, 0.0};
  }
  CameraComparison comparison;
  comparison.Add(dataset);
  double slope = 0.5;
  for (int i = 0; i < 100; ++i) slope = 0.5 + 0.2 * slope * slope * slope;
  EXPECT_NEAR(comparison.Medians()->vertical_fov_deg, DegFromRad(2.0 * (std::atan(slope) - std::atan(0.5))), 1e-9);
  EXPECT_NEAR(comparison.Medians()->centred_rotation_deg, 0.0, 1e-6);
}

/// Three cameras at the corners of a triangle, solved exactly in another frame and with another scale.
Dataset ThreePlacedCameras(double scale, LengthUnit unit) {
  Dataset dataset = TwoCameras();
  std::vector<CameraView>& views = dataset.sequences[0].cameras;
  views.push_back(views[0]);
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d centres[] = {{0, 0, 0}, {3000, 0, 0}, {0, 0, 4000}};
  for (std::size_t v = 0; v < 3; ++v) {
    Camera& truth = views[v].calibration[0];
    truth.camera_from_world_translation = -truth.camera_from_world_rotation * centres[v];
    Camera solved = truth;
    solved.camera_from_world_rotation *= rotation.transpose();
    solved.camera_from_world_translation *= scale;
    views[v].solved_calibration = {solved};
    views[v].image_size = {2000, 2000};
    views[v].solved.unit = unit;
  }
  return dataset;
}

TEST(CameraComparisonTest, PositionsAreComparedWithAndWithoutScale) {
  CameraComparison metric;
  metric.Add(ThreePlacedCameras(1.1, LengthUnit::kMillimetres));
  EXPECT_NEAR(metric.Medians()->scaled_translation_mm.value(), 0.0, 1e-6);
  // Each centre is a tenth of its distance from the mean of all too far out.
  const double expected = 0.1 *
                          (Eigen::Vector2d(1000, 4000.0 / 3).norm() + Eigen::Vector2d(2000, 4000.0 / 3).norm() +
                           Eigen::Vector2d(1000, 8000.0 / 3).norm()) /
                          3.0;
  EXPECT_NEAR(metric.Medians()->translation_mm.value(), expected, 1e-6);

  CameraComparison without_unit;
  without_unit.Add(ThreePlacedCameras(0.001, LengthUnit::kBodyLengths));
  EXPECT_FALSE(without_unit.Medians()->translation_mm);
  EXPECT_NEAR(without_unit.Medians()->scaled_translation_mm.value(), 0.0, 1e-6);
}

TEST(CameraComparisonTest, AnglesAreMeansOverPairsAndFieldsOfView) {
  Dataset dataset = ThreePlacedCameras(1.0, LengthUnit::kMillimetres);
  Camera& first = dataset.sequences[0].cameras[0].solved_calibration[0];
  first.camera_from_world_rotation = CameraOf(1.0, 0.03).camera_from_world_rotation * first.camera_from_world_rotation;
  first.K(1, 1) = 2000.0;
  CameraComparison comparison;
  comparison.Add(dataset);
  EXPECT_NEAR(comparison.Medians()->angle_deg, DegFromRad(0.03) * 2.0 / 3.0, 1e-6);  // two of three pairs
  // 2000 px high: 90 degrees with a focal length of 1000, 53.13 with 2000.
  EXPECT_NEAR(comparison.Medians()->vertical_fov_deg, (90.0 - 53.1301) / 3.0, 1e-3);
}

TEST(CameraComparisonTest, WithoutCamerasToCompareThereIsNoResult) {
  CameraComparison comparison;
  comparison.Add(TwoCameras());
  EXPECT_FALSE(comparison.Medians());
}

}  // namespace
}  // namespace canonpose
