#include "canonpose/data/everybody.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

constexpr int kKeypoints = 5;

/// Keypoints on a slope whose first one is at `x`.
DetectedPerson PersonAt(float x) {
  DetectedPerson person;
  for (int k = 0; k < kKeypoints; ++k) {
    person.keypoints.push_back(x + static_cast<float>(10 * k));
    person.keypoints.push_back(static_cast<float>(40 * k));
    person.confidence.push_back(0.9F);
  }
  return person;
}

/// One person in all ten frames, another in the last six, and a third, far away, in one.
DetectedCamera ThreePeople() {
  DetectedCamera camera;
  camera.name = "cam";
  camera.path = "somewhere";
  camera.keypoint_count = kKeypoints;
  for (int t = 0; t < 10; ++t) {
    DetectedFrame frame;
    frame.number = 100 + t;
    if (t >= 4) frame.people.push_back(PersonAt(600.0F));
    frame.people.push_back(PersonAt(static_cast<float>(t)));
    if (t == 5) frame.people.push_back(PersonAt(2000.0F));
    camera.frames.push_back(std::move(frame));
  }
  return camera;
}

TEST(Everybody, AreFollowedOneAfterTheOther) {
  const KeypointClip clip = FollowEverybody(ThreePeople());
  ASSERT_EQ(clip.frame_count(), 20);
  EXPECT_EQ(clip.keypoint_count, kKeypoints);
  EXPECT_EQ(clip.frame_numbers[10], 100);
  for (std::size_t t = 0; t < 10; ++t) {
    EXPECT_EQ(clip.keypoints[2 * t * kKeypoints], static_cast<float>(t));
    EXPECT_EQ(clip.confidence[(10 + t) * kKeypoints], t >= 4 ? 0.9F : 0.0F);
    EXPECT_EQ(std::isnan(clip.keypoints[2 * (10 + t) * kKeypoints]), t < 4);
  }
}

TEST(Everybody, SideBySideAndBackIsTheSame) {
  const KeypointClip clip = FollowEverybody(ThreePeople());
  const KeypointClip wide = PeopleSideBySide(clip);
  EXPECT_EQ(wide.frame_count(), 10);
  EXPECT_EQ(wide.keypoint_count, 2 * kKeypoints);
  const std::vector<KeypointClip> people = SplitPeople(wide, kKeypoints);
  ASSERT_EQ(people.size(), 2U);
  std::vector<float> confidence;
  std::vector<float> keypoints;
  for (const KeypointClip& person : people) {
    EXPECT_EQ(person.frame_numbers, wide.frame_numbers);
    confidence.insert(confidence.end(), person.confidence.begin(), person.confidence.end());
    keypoints.insert(keypoints.end(), person.keypoints.begin(), person.keypoints.end());
  }
  EXPECT_EQ(confidence, clip.confidence);
  EXPECT_TRUE(std::ranges::equal(keypoints, clip.keypoints,
                                 [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
}

TEST(Everybody, ACameraThatSeesNobodyIsAnError) {
  DetectedCamera camera = ThreePeople();
  for (DetectedFrame& frame : camera.frames) frame.people.clear();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FollowEverybody(camera); }), HasSubstr("nobody in any frame"));
}

}  // namespace
}  // namespace canonpose
