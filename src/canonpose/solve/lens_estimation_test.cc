#include "canonpose/solve/lens_estimation.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using testing::ExactRig;
using testing::ExactRigOptions;
using testing::MakeExactRig;
using testing::SeeJoints;
using testing::SeeThrough;

/// Of adults who are filmed from nearby: keypoints reach into the corners of the images.
ExactRigOptions Near(bool static_cameras) {
  ExactRigOptions options;
  options.static_cameras = static_cameras;
  options.frames = 100;
  options.distance = 0.9;
  return options;
}

/// The best solution without lenses.
Solution Pinhole(const ExactRig& rig, std::span<const int> frames) {
  Solution solution;
  solution.estimate = rig.truth;
  for (int round = 0; round < 2; ++round) {
    solution.scales.observation = MeasureNoise(rig.capture, frames, solution.estimate);
    AdjustmentOptions options;
    options.scales = solution.scales;
    options.fixed_view = rig.capture.static_cameras ? 0 : -1;
    solution.calibration_summary = Adjust(rig.capture, frames, options, solution.estimate);
  }
  solution.scales.observation = MeasureNoise(rig.capture, frames, solution.estimate);
  return solution;
}

/// Calibrates as Pinhole() does, from the truth.
Calibrate FromTruth(const ExactRig& rig) {
  return [truth = rig.truth](const CaptureObservations& capture) {
    return Pinhole({truth, capture}, ConsecutiveFrames(0, capture.frame_count));
  };
}

TEST(Lenses, AreFoundWhereTheyDistort) {
  ExactRig rig = MakeExactRig(Near(true));
  SeeJoints(rig.truth, 0.002, 5, rig.capture);
  const std::vector<RadialLens> lenses = {{{-0.2, 0.06}}, {{-0.15, 0.03}}, {{-0.25, 0.06}}, {{-0.2, 0.04}}};
  const CaptureObservations undistorted = rig.capture;
  SeeThrough(lenses, rig.capture);
  const std::vector<int> frames = ConsecutiveFrames(0, rig.capture.frame_count);
  Solution solution = Pinhole(rig, frames);
  const double scatter_before = solution.scales.observation.Typical();
  ASSERT_TRUE(FindLenses(frames, {0, 1, 2, 3}, FromTruth(rig), rig.capture, solution));
  EXPECT_LT(solution.scales.observation.Typical(), scatter_before);
  // Keypoints are where cameras without distortion see them: what counts is the shift where keypoints are, not the
  // coefficients, which partly stand for each other and for the focal length.
  double squares_before = 0.0;
  double squares = 0.0;
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    for (int v = 0; v < rig.capture.view_count(); ++v) {
      for (int j = 0; j < rig.capture.joint_count(); ++j) {
        const Eigen::Vector2d truth = undistorted.At(n, v, j);
        squares += (rig.capture.At(n, v, j) - truth).squaredNorm();
        squares_before += (lenses[static_cast<std::size_t>(v)].Distort(truth) - truth).squaredNorm();
      }
    }
  }
  EXPECT_LT(squares, 0.1 * squares_before);
  EXPECT_TRUE(solution.calibration_summary.IsUsable());
}

TEST(Lenses, AreLeftAloneWhereTheyDoNotDistort) {
  ExactRig rig = MakeExactRig(Near(true));
  SeeJoints(rig.truth, 0.004, 6, rig.capture);
  const std::vector<int> frames = ConsecutiveFrames(0, rig.capture.frame_count);
  Solution solution = Pinhole(rig, frames);
  const CaptureObservations capture_before = rig.capture;
  const Solution before = solution;
  EXPECT_FALSE(FindLenses(frames, {0, 1, 2, 3}, FromTruth(rig), rig.capture, solution));
  EXPECT_EQ(rig.capture.xy, capture_before.xy);
  for (const ObservedCamera& camera : rig.capture.cameras) EXPECT_TRUE(camera.lens.IsNone());
  EXPECT_EQ(solution.estimate.joints, before.estimate.joints);
}

TEST(Lenses, OfMovingCamerasAreLeftAlone) {
  ExactRig rig = MakeExactRig(Near(false));
  SeeThrough(std::vector<RadialLens>(4, RadialLens{{-0.2, 0.06}}), rig.capture);
  const std::vector<int> frames = ConsecutiveFrames(0, rig.capture.frame_count);
  Solution solution = Pinhole(rig, frames);
  const std::vector<float> recorded = rig.capture.xy;
  EXPECT_FALSE(FindLenses(frames, {0, 1, 2, 3}, FromTruth(rig), rig.capture, solution));
  EXPECT_EQ(rig.capture.xy, recorded);
}

TEST(Lenses, OfOneModelAreTheSame) {
  ExactRig rig = MakeExactRig(Near(true));
  SeeJoints(rig.truth, 0.002, 7, rig.capture);
  SeeThrough(std::vector<RadialLens>(4, RadialLens{{-0.2, 0.06}}), rig.capture);
  const std::vector<int> frames = ConsecutiveFrames(0, rig.capture.frame_count);
  Solution solution = Pinhole(rig, frames);
  ASSERT_TRUE(FindLenses(frames, {0, 1, 0, 1}, FromTruth(rig), rig.capture, solution));
  EXPECT_EQ(rig.capture.cameras[0].lens, rig.capture.cameras[2].lens);
  EXPECT_EQ(rig.capture.cameras[1].lens, rig.capture.cameras[3].lens);
  EXPECT_NE(rig.capture.cameras[0].lens, rig.capture.cameras[1].lens);
}

TEST(Lenses, AreNumberedByTheCamerasThatShareThem) {
  const CaptureObservations capture = MakeExactRig().capture;  // camera0 .. camera3
  EXPECT_THAT(LensOfViews(capture, {}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(LensOfViews(capture, {{"all"}}), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(LensOfViews(capture, {{"camera1", "camera3"}}), ElementsAre(0, 1, 2, 1));
  EXPECT_THAT(LensOfViews(capture, {{"camera3", "camera0"}, {"elsewhere", "camera2"}}), ElementsAre(0, 1, 2, 0));
}

TEST(Lenses, SetLensUndoesTheLensBefore) {
  CaptureObservations capture = MakeExactRig(Near(true)).capture;
  testing::Hide(capture, 3, 1, 2);
  const CaptureObservations recorded = capture;
  SetLens(capture, 1, {{-0.3, 0.1}});
  EXPECT_GT((capture.At(0, 1, 3) - recorded.At(0, 1, 3)).norm(), 1e-4);
  EXPECT_EQ(capture.At(0, 0, 3), recorded.At(0, 0, 3));
  EXPECT_TRUE(std::isnan(capture.At(3, 1, 2).x()));
  SetLens(capture, 1, {{0.1, 0.0}});
  EXPECT_LT((RadialLens{{0.1, 0.0}}.Distort(capture.At(0, 1, 3)) - recorded.At(0, 1, 3)).norm(), 1e-6);
  SetLens(capture, 1, {});
  EXPECT_LT((capture.At(0, 1, 3) - recorded.At(0, 1, 3)).norm(), 1e-6);
}

}  // namespace
}  // namespace canonpose
