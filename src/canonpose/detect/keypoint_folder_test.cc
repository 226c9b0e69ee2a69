#include "canonpose/detect/keypoint_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/openpose.h"
#include "canonpose/data/readers/video_facts.h"
#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::StandingPerson;

VideoKeypoints TwoPeople(int frames) {
  VideoKeypoints keypoints;
  keypoints.name = "cam1";
  keypoints.video = "cam1.mp4";
  keypoints.image_size = {640, 480};
  keypoints.fps = 25.0;
  keypoints.subject = "subject";
  for (int t = 0; t < frames; ++t) {
    keypoints.times_seconds.push_back(0.04 * t);
    keypoints.frames.push_back({{3, StandingPerson(100, 200, 40)}, {7, StandingPerson(400, 250, 80)}});
  }
  return keypoints;
}

TEST(KeypointFolder, IsReadBackAsWritten) {
  const testing::TemporaryFolder folder;
  VideoKeypoints keypoints = TwoPeople(6);
  keypoints.frames[2].erase(keypoints.frames[2].begin());
  FinishPeople(keypoints);
  WriteKeypointFolder(folder / "cam1", keypoints);
  const DetectedCamera camera = ReadOpenPose({"cam1", folder / "cam1"});
  ASSERT_THAT(camera.frames, SizeIs(6));
  EXPECT_EQ(camera.keypoint_count, 17);
  ASSERT_THAT(camera.frames[0].people, SizeIs(2));
  // The larger is number 0.
  EXPECT_EQ(camera.frames[0].people[0].track_id, 0);
  EXPECT_NEAR(camera.frames[0].people[0].keypoints[0], 400, 0.005);
  EXPECT_NEAR(camera.frames[0].people[0].confidence[0], 0.8, 5e-4);
  EXPECT_EQ(camera.frames[0].people[1].track_id, 1);
  ASSERT_THAT(camera.frames[2].people, SizeIs(1));
  EXPECT_EQ(camera.frames[2].people[0].track_id, 0);
  const std::optional<VideoFacts> facts = ReadVideoFacts(folder / "cam1");
  ASSERT_TRUE(facts);
  EXPECT_THAT(facts->image_size, ElementsAre(640, 480));
  EXPECT_EQ(facts->fps, 25.0);
  ASSERT_THAT(facts->times_seconds, SizeIs(6));
  EXPECT_NEAR(facts->times_seconds[5], 0.2, 1e-9);
  EXPECT_EQ(SubjectOfFolder(folder / "cam1"), "subject");
  EXPECT_EQ(SubjectOfFolder(folder / "gone"), "");
}

TEST(KeypointFolder, IsWrittenForNamesThatAreNotUtf8) {
  const testing::TemporaryFolder folder;
  VideoKeypoints keypoints = TwoPeople(3);
  keypoints.video = "caf\xE9.mp4";  // Latin-1
  WriteKeypointFolder(folder / "cam1", keypoints);
  EXPECT_THAT(ReadFile(folder / "cam1/video.json"), HasSubstr("\"video\": \"caf\xEF\xBF\xBD.mp4\""));
  const std::optional<VideoFacts> facts = ReadVideoFacts(folder / "cam1");
  ASSERT_TRUE(facts);
  EXPECT_THAT(facts->times_seconds, SizeIs(3));
}

TEST(FinishPeople, LeavesOutWhoIsHardlySeenAndJointsOutside) {
  VideoKeypoints keypoints = TwoPeople(20);
  keypoints.frames[4].push_back({9, StandingPerson(500, 240, 30)});  // in one frame
  for (auto& frame : keypoints.frames) {
    frame.push_back({11, StandingPerson(300, 240, 30, 0.22F)});  // a coat
    frame[0].pose.joints[kLWrist].position.x() = -3.0F;
  }
  FinishPeople(keypoints);
  for (const auto& frame : keypoints.frames) {
    ASSERT_THAT(frame, SizeIs(2));
    EXPECT_EQ(frame[1].pose.joints[kLWrist].score, 0.0F);
    EXPECT_EQ(frame[1].pose.joints[kRWrist].score, 0.8F);
  }
}

TEST(FinishPeople, KeepsWhoIsSeenInAVeryShortVideo) {
  VideoKeypoints keypoints = TwoPeople(2);
  FinishPeople(keypoints);
  EXPECT_THAT(keypoints.frames[0], SizeIs(2));
}

TEST(MeanRate, IsTheStatedOneUnlessTimesDiffer) {
  EXPECT_EQ(MeanRate({0.0, 0.0333, 0.0667}, 29.97), 29.97);
  EXPECT_NEAR(MeanRate({0.0, 0.05, 0.2}, 30.0), 10.0, 1e-9);
  EXPECT_EQ(MeanRate({}, 25.0), 25.0);
  EXPECT_EQ(MeanRate({0.0}, 0.0), 0.0);
}

}  // namespace
}  // namespace canonpose
