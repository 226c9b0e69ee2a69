#include "canonpose/data/sequence_triangulation.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/data/two_cameras_testing.h"

namespace canonpose {
namespace {

using testing::TwoCameras;

TEST(TriangulateSequence, GivesPosesInEachCamerasFrame) {
  const SequencePoses poses = TriangulateSequence(TwoCameras().sequences[0], TwoCameras().skeleton);
  const std::vector<float>& a = poses.poses_in_camera[0].positions();
  const std::vector<float>& b = poses.poses_in_camera[1].positions();
  EXPECT_NEAR(a[3], 200.0F, 0.05F);
  EXPECT_NEAR(a[4], 300.0F, 0.05F);
  EXPECT_NEAR(a[5], 4100.0F, 0.05F);
  EXPECT_NEAR(b[3], 100.0F, 0.05F);
  EXPECT_NEAR(b[5], 3800.0F, 0.05F);
  EXPECT_EQ(poses.poses_in_camera[1].unit, LengthUnit::kMillimetres);
  EXPECT_EQ(poses.poses_in_camera[1].coordinate_frame, (CoordinateFrame{CoordinateFrame::Kind::kCamera, "b"}));
}

TEST(TriangulateSequence, AJointThatOneViewMissesIsUnknown) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[1].confidence[2] = 0.0F;
  std::vector<double> errors_px = {1.0};
  const SequencePoses poses = TriangulateSequence(dataset.sequences[0], dataset.skeleton, &errors_px);
  EXPECT_TRUE(std::isnan(poses.poses_in_camera[0].positions()[6]));
  EXPECT_EQ(errors_px.size(), 5U) << "two joints in two views, after what was there";
}

TEST(TriangulateSequence, NearlyParallelRaysGiveNothing) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[1] = dataset.sequences[0].cameras[0];
  dataset.sequences[0].cameras[1].calibration[0].camera_from_world_translation.x() += 50.0;
  EXPECT_TRUE(
      std::isnan(TriangulateSequence(dataset.sequences[0], dataset.skeleton).poses_in_camera[0].positions()[0]));
}

TEST(TriangulateSequence, CamerasWithoutCalibrationGetNoPoses) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras.push_back(dataset.sequences[0].cameras[1]);
  dataset.sequences[0].cameras[1].calibration.clear();
  const SequencePoses poses = TriangulateSequence(dataset.sequences[0], dataset.skeleton);
  EXPECT_TRUE(poses.poses_in_camera[1].empty());
  EXPECT_NEAR(poses.poses_in_camera[0].positions()[3], 200.0F, 0.05F);
}

/// The sequence twice over: frame 1 shows what frame 0 shows.
Dataset TwoFrames() {
  Dataset dataset = TwoCameras();
  Sequence& sequence = dataset.sequences[0];
  sequence.frame_count = 2;
  for (CameraView& view : sequence.cameras) {
    const std::vector<float> keypoints = view.keypoints;
    const std::vector<float> confidence = view.confidence;
    view.keypoints.insert(view.keypoints.end(), keypoints.begin(), keypoints.end());
    view.confidence.insert(view.confidence.end(), confidence.begin(), confidence.end());
  }
  return dataset;
}

TEST(TriangulateSequence, BringsCamerasToOneTime) {
  Dataset dataset = TwoFrames();
  Sequence& sequence = dataset.sequences[0];
  // Camera b is one frame late: what it shows in its frame 0, camera a shows in frame 1.
  sequence.cameras[1].time_offset_seconds = 1.0 / sequence.fps;
  const SequencePoses poses = TriangulateSequence(sequence, dataset.skeleton);
  EXPECT_FALSE(poses.poses_in_camera[0].IsKnown(0, 1));
  EXPECT_TRUE(poses.poses_in_camera[0].IsKnown(1, 1));
  EXPECT_TRUE(poses.poses_in_camera[1].IsKnown(0, 1));
  EXPECT_FALSE(poses.poses_in_camera[1].IsKnown(1, 1));
}

TEST(TriangulateSequence, InterpolatesWhereClocksDifferByFractions) {
  Dataset dataset = TwoFrames();
  Sequence& sequence = dataset.sequences[0];
  const SequencePoses in_step = TriangulateSequence(sequence, dataset.skeleton);
  sequence.cameras[1].time_offset_seconds = -0.4 / sequence.fps;
  const SequencePoses poses = TriangulateSequence(sequence, dataset.skeleton);
  // Nothing moves, so that joints are where they were in the one frame that both cameras show.
  EXPECT_TRUE(poses.poses_in_camera[0].IsKnown(0, 1));
  EXPECT_FALSE(poses.poses_in_camera[0].IsKnown(1, 1)) << "camera b ended 0.4 frames before";
  EXPECT_TRUE(poses.poses_in_camera[0].PoseAt(0).row(1).isApprox(in_step.poses_in_camera[0].PoseAt(0).row(1), 1e-5F));
}

TEST(TriangulateSequence, DoesNotUseWhatSolveLeftOut) {
  Dataset dataset = TwoFrames();
  Sequence& sequence = dataset.sequences[0];
  for (CameraView& view : sequence.cameras) {
    view.solved = PosesInCamera(dataset.skeleton, std::vector<float>(3 * view.confidence.size(), 1.0F),
                                LengthUnit::kBodyLengths, view.name);
  }
  EXPECT_TRUE(TriangulateSequence(sequence, dataset.skeleton).poses_in_camera[0].IsKnown(1, 1));
  for (std::size_t i = sequence.cameras[1].solved.positions().size() / 2;
       i < sequence.cameras[1].solved.positions().size(); ++i) {
    sequence.cameras[1].solved.positions()[i] = std::nanf("");
  }
  const SequencePoses poses = TriangulateSequence(sequence, dataset.skeleton);
  EXPECT_TRUE(poses.poses_in_camera[0].IsKnown(0, 1));
  EXPECT_FALSE(poses.poses_in_camera[0].IsKnown(1, 1));
}

}  // namespace
}  // namespace canonpose
