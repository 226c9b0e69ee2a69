#include "canonpose/data/detection_cleaning.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::CollectedMessages;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kKeypoints = 17;

/// Somebody 400 px tall; `noise` in pixels.
DetectedPerson Somebody(double x, double confidence, double noise, Rng& rng) {
  DetectedPerson person;
  for (int k = 0; k < kKeypoints; ++k) {
    person.keypoints.push_back(static_cast<float>(x + 60.0 * std::sin(2.4 * k) + noise * rng.Normal()));
    person.keypoints.push_back(static_cast<float>(300.0 + 25.0 * k + noise * rng.Normal()));
    person.confidence.push_back(static_cast<float>(confidence));
  }
  return person;
}

DetectedCamera Camera(int frames) {
  DetectedCamera camera;
  camera.name = "cam";
  camera.keypoint_count = kKeypoints;
  camera.frames.resize(static_cast<std::size_t>(frames));
  for (int t = 0; t < frames; ++t) camera.frames[static_cast<std::size_t>(t)].number = t;
  return camera;
}

// Two mice that a format keeps apart are always there, in one order: that looks like a mere count.
TEST(DropUselessTrackIds, IndividualsOfTheFormatKeepTheirs) {
  for (const bool has_tracks : {false, true}) {
    Rng rng(7);
    DetectedCamera camera = Camera(10);
    camera.has_tracks = has_tracks;
    for (DetectedFrame& frame : camera.frames) {
      frame.people = {Somebody(200.0, 0.8, 1.0, rng), Somebody(700.0, 0.8, 1.0, rng)};
      for (std::size_t p = 0; p < 2; ++p) frame.people[p].track_id = static_cast<std::int64_t>(p);
    }
    DropUselessTrackIds(camera);
    EXPECT_EQ(camera.frames[3].people[1].track_id.has_value(), has_tracks);
  }
}

TEST(MergeDuplicates, OnePersonFoundTwiceIsOne) {
  for (const double share : {0.05, 0.3, 0.9, 1.0}) {
    for (const double noise : {0.0, 6.0, 15.0}) {
      Rng rng(7);
      DetectedCamera camera = Camera(100);
      for (DetectedFrame& frame : camera.frames) {
        frame.people.push_back(Somebody(500.0, 0.8, 1.0, rng));
        if (rng.Uniform() >= share) continue;
        const auto at = rng.Index(2);
        frame.people.insert(frame.people.begin() + static_cast<std::ptrdiff_t>(at), Somebody(500.0, 0.6, noise, rng));
      }
      const CollectedMessages messages;
      MergeDuplicates(camera);
      for (const DetectedFrame& frame : camera.frames) {
        ASSERT_EQ(frame.people.size(), 1U) << share << " " << noise;
        EXPECT_EQ(frame.people[0].confidence[0], 0.8F);
      }
      EXPECT_THAT(messages.text(), HasSubstr("frames one person was found twice"));
    }
  }
}

TEST(MergeDuplicates, APartOfAPersonIsNotAnother) {
  Rng rng(7);
  DetectedCamera camera = Camera(10);
  for (DetectedFrame& frame : camera.frames) {
    frame.people = {Somebody(500.0, 0.9, 3.0, rng), Somebody(500.0, 0.7, 1.0, rng)};
    for (std::size_t k = 6; k < kKeypoints; ++k) {
      frame.people[0].confidence[k] = 0.0F;
      frame.people[0].keypoints[2 * k] = frame.people[0].keypoints[2 * k + 1] = std::nanf("");
    }
  }
  MergeDuplicates(camera);
  for (const DetectedFrame& frame : camera.frames) {
    ASSERT_EQ(frame.people.size(), 1U);
    EXPECT_EQ(frame.people[0].confidence[10], 0.7F);
  }
}

TEST(MergeDuplicates, PeopleWhoPassEachOtherAreTwo) {
  Rng rng(7);
  DetectedCamera camera = Camera(101);
  for (int t = 0; t <= 100; ++t) {
    camera.frames[static_cast<std::size_t>(t)].people = {Somebody(700.0 + 4.0 * (t - 50), 0.8, 1.0, rng),
                                                         Somebody(700.0 - 4.0 * (t - 50), 0.7, 1.0, rng)};
  }
  const CollectedMessages messages;
  MergeDuplicates(camera);
  for (const DetectedFrame& frame : camera.frames) EXPECT_EQ(frame.people.size(), 2U);
  EXPECT_THAT(messages.text(), IsEmpty());
}

TEST(MergeDuplicates, SomebodyElseStays) {
  Rng rng(7);
  DetectedCamera camera = Camera(60);
  for (DetectedFrame& frame : camera.frames) {
    frame.people = {Somebody(500.0, 0.8, 1.0, rng), Somebody(900.0, 0.7, 1.0, rng)};
    if (rng.Uniform() < 0.3) frame.people.push_back(Somebody(500.0, 0.6, 6.0, rng));
  }
  MergeDuplicates(camera);
  for (const DetectedFrame& frame : camera.frames) EXPECT_EQ(frame.people.size(), 2U);
}

/// Whether ids that `id_of` gives the people of 20 frames, of which every fourth has one person, are kept.
template <typename IdOf>
bool KeepsIds(IdOf&& id_of) {
  Rng rng(7);
  DetectedCamera camera = Camera(20);
  for (std::size_t t = 0; t < 20; ++t) {
    std::vector<DetectedPerson>& people = camera.frames[t].people;
    people.push_back(Somebody(500.0, 0.8, 1.0, rng));
    if (t % 4 != 0) people.push_back(Somebody(900.0, 0.7, 1.0, rng));
    for (std::size_t p = 0; p < people.size(); ++p) people[p].track_id = id_of(t, p);
  }
  DropUselessTrackIds(camera);
  return camera.frames[1].people[1].track_id.has_value();
}

TEST(DropUselessTrackIds, AnIdThatEverybodyHasIdentifiesNobody) {
  EXPECT_FALSE(KeepsIds([](std::size_t, std::size_t) { return 0; }));
  EXPECT_FALSE(KeepsIds([](std::size_t t, std::size_t) { return static_cast<std::int64_t>(t); }));
  EXPECT_FALSE(KeepsIds([](std::size_t, std::size_t p) { return static_cast<std::int64_t>(p); }));
  EXPECT_FALSE(KeepsIds([](std::size_t, std::size_t p) { return static_cast<std::int64_t>(p) + 1; }));
  EXPECT_TRUE(KeepsIds([](std::size_t, std::size_t p) { return static_cast<std::int64_t>(p) + 7; }));
  EXPECT_TRUE(KeepsIds([](std::size_t, std::size_t p) { return 1 - static_cast<std::int64_t>(p); }));
}

}  // namespace
}  // namespace canonpose
