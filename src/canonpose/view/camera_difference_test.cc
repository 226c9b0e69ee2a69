#include "canonpose/view/camera_difference.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "canonpose/view/page_testing.h"

namespace canonpose {
namespace {

TEST(CompareCameras, FindsNothingWhereKeypointsAreExact) {
  const ShownScene shown = testing::WalkingScene(2, 30);
  for (const CameraDifference& difference : CompareCameras(shown)) {
    EXPECT_LT(difference.median_px, 1e-2);
    ASSERT_EQ(difference.by_frame_px.size(), 30U);
    EXPECT_LT(difference.by_frame_px[7], 1e-2);
  }
}

TEST(CompareCameras, SaysHowFarWhichCameraIsOff) {
  ShownScene shown = testing::WalkingScene(1, 30);
  ViewKeypoints& seen = shown.detections[0][2];
  for (std::size_t i = 0; i < seen.keypoints.size(); i += 2) seen.keypoints[i] += 6.0F;
  const std::vector<CameraDifference> differences = CompareCameras(shown);
  EXPECT_NEAR(differences[2].median_px, 6.0, 1e-2);
  EXPECT_NEAR(differences[2].by_frame_px[3], 6.0, 1e-2);
  EXPECT_NEAR(differences[2].by_joint_px[5], 6.0, 1e-2);
  EXPECT_LT(differences[1].median_px, 1e-2);
  // 6 px at 4.5 m and 1400 px are 19 mm; of 4 m of bones that is half a percent.
  EXPECT_NEAR(differences[2].median_percent, 0.5, 0.2);
}

TEST(CompareCameras, LeavesOutWhatWasNotDetectedOrIsNotSolved) {
  ShownScene shown = testing::WalkingScene(1, 10);
  ViewKeypoints& seen = shown.detections[0][0];
  seen.confidence[3] = 0.0F;
  seen.keypoints[6] = 1e6F;
  shown.scene.people[0].PoseAt(4).setConstant(std::numeric_limits<float>::quiet_NaN());
  const std::vector<CameraDifference> differences = CompareCameras(shown);
  EXPECT_LT(differences[0].by_frame_px[0], 1e-2);
  EXPECT_TRUE(std::isnan(differences[0].by_frame_px[4]));
}

TEST(CompareCameras, LooksAtTheTimeThatACameraShows) {
  ShownScene shown = testing::WalkingScene(1, 40);
  const SceneCamera camera = shown.scene.cameras[1];
  // This camera shows in frame n what the people do 2.5 frames later.
  PoseSequence later = shown.scene.people[0];
  for (int t = 0; t < 40; ++t) {
    for (int j = 0; j < later.joint_count(); ++j) {
      const Eigen::Vector3d point = JointAt(shown.scene.people[0], t + 2.5, j);
      later.PoseAt(t).row(j) = point.transpose().cast<float>();
    }
  }
  shown.detections[0][1] = testing::SeenExactly(camera, later);
  EXPECT_GT(CompareCameras(shown)[1].median_px, 5.0);
  shown.scene.cameras[1].time_offset_seconds = 2.5 / 25.0;
  EXPECT_LT(CompareCameras(shown)[1].median_px, 1e-2);
}

TEST(CompareCameras, OfUnknownCamerasIsUnknown) {
  ShownScene shown = testing::WalkingScene(1, 10);
  shown.scene.cameras[0].calibration.clear();
  EXPECT_TRUE(std::isnan(CompareCameras(shown)[0].median_px));
}

}  // namespace
}  // namespace canonpose
