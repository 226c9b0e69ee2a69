#include "canonpose/data/person_tracking.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/log.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::CollectedMessages;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Shared;
using testing::TemporaryFolder;
using testing::TestData;

constexpr int kKeypoints = 17;

/// Somebody of a height in pixels around a place; the shape of the cloud depends on nothing else.
DetectedPerson Somebody(double x, double y, double height, double confidence, Rng& rng) {
  DetectedPerson person;
  for (int k = 0; k < kKeypoints; ++k) {
    const double across = 0.15 * height * std::sin(2.4 * k);
    const double down = height * (static_cast<double>(k) / (kKeypoints - 1) - 0.5);
    person.keypoints.push_back(static_cast<float>(x + across + rng.Normal()));
    person.keypoints.push_back(static_cast<float>(y + down + rng.Normal()));
    person.confidence.push_back(static_cast<float>(confidence));
  }
  return person;
}

/// A frame with its people in random order; `who` gets the number of each person in that order.
struct Scene {
  DetectedCamera camera;
  std::vector<std::vector<int>> who;
};

/// place(frame, person) is a person's x, NaN where not seen.
template <typename Place>
Scene MakeScene(int frames, const std::vector<double>& heights, const std::vector<double>& confidences, Place&& place) {
  Scene scene;
  scene.camera.name = "cam";
  scene.camera.path = "somewhere";
  scene.camera.keypoint_count = kKeypoints;
  Rng rng(5);
  for (int t = 0; t < frames; ++t) {
    DetectedFrame frame;
    frame.number = t;
    scene.who.emplace_back();
    for (const std::size_t p : rng.Permutation(heights.size())) {
      const double x = place(t, static_cast<int>(p));
      if (std::isnan(x)) continue;
      frame.people.push_back(Somebody(x, 500.0, heights[p], confidences[p], rng));
      scene.who.back().push_back(static_cast<int>(p));
    }
    scene.camera.frames.push_back(frame);
  }
  return scene;
}

/// In how many sightings a track holds each of two people.
std::array<int, 2> CountPeople(const Scene& scene, const PersonTrack& track) {
  std::array<int, 2> counts{0, 0};
  for (const PersonTrack::Sighting& sighting : track.sightings) {
    const int who = scene.who[static_cast<std::size_t>(sighting.frame)][static_cast<std::size_t>(sighting.person)];
    ++counts[static_cast<std::size_t>(who)];
  }
  return counts;
}

TEST(TrackPeople, FollowsOnePersonThroughChangingOrder) {
  const Scene scene = MakeScene(100, {400, 300}, {0.8, 0.5}, [](int t, int p) { return 300.0 + 400.0 * p + t; });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{100, 0}));
  EXPECT_EQ(CountPeople(scene, tracks[1]), (std::array<int, 2>{0, 100}));
}

TEST(TrackPeople, PeopleWhoCrossDoNotSwap) {
  for (const double speed : {2.0, 5.0, 12.0}) {
    const Scene scene = MakeScene(101, {400, 400}, {0.8, 0.5},
                                  [&](int t, int p) { return 700.0 + (p == 0 ? speed : -speed) * (t - 50); });
    const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
    ASSERT_EQ(tracks.size(), 2U) << speed;
    EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{101, 0})) << speed;
  }
}

TEST(TrackPeople, PeopleWhoCrossBehindEachOtherDoNotSwap) {
  // The one behind is not seen for ten frames around the crossing.
  const Scene scene = MakeScene(101, {400, 400}, {0.8, 0.7}, [&](int t, int p) {
    if (p == 1 && std::abs(t - 50) < 6) return std::nan("");
    return 700.0 + (p == 0 ? 10.0 : -10.0) * (t - 50);
  });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{101, 0}));
  EXPECT_EQ(CountPeople(scene, tracks[1]), (std::array<int, 2>{0, 90}));
}

TEST(TrackPeople, SurvivesGaps) {
  const Scene scene = MakeScene(120, {400, 300}, {0.8, 0.6}, [](int t, int p) {
    return p == 0 && t >= 40 && t < 80 ? std::nan("") : 300.0 + 500.0 * p + 0.5 * t;
  });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{80, 0}));
}

TEST(TrackPeople, MissingKeypointsDoNotBreakATrack) {
  Scene scene = MakeScene(100, {400}, {0.8}, [](int t, int) { return 300.0 + 3.0 * t; });
  Rng rng(9);
  for (DetectedFrame& frame : scene.camera.frames) {
    for (std::size_t k = 0; k < kKeypoints; ++k) {
      if (rng.Uniform() < 0.6) continue;
      frame.people[0].confidence[k] = 0.0F;
      frame.people[0].keypoints[2 * k] = frame.people[0].keypoints[2 * k + 1] = std::nanf("");
    }
  }
  EXPECT_EQ(TrackPeople(scene.camera).size(), 1U);
}

TEST(TrackPeople, TrackIdsLinkDetectionsThatDistanceDoesNot) {
  // After a long absence far away from where the person was, with somebody else about: only the id says who it is.
  Scene scene = MakeScene(200, {400, 400}, {0.8, 0.8}, [](int t, int p) {
    if (p == 1) return 2000.0;
    return t >= 50 && t < 150 ? std::nan("") : 300.0 + (t < 50 ? 0.0 : 900.0);
  });
  EXPECT_EQ(TrackPeople(scene.camera).size(), 3U);
  for (std::size_t t = 0; t < scene.camera.frames.size(); ++t) {
    for (std::size_t i = 0; i < scene.who[t].size(); ++i) scene.camera.frames[t].people[i].track_id = scene.who[t][i];
  }
  EXPECT_EQ(TrackPeople(scene.camera).size(), 2U);
}

/// The messages of following the most prominent person.
std::string FollowLog(const Scene& scene) {
  const CollectedMessages messages;
  FollowPerson(scene.camera, 1);
  return messages.text();
}

TEST(TrackPeople, ALonePersonReturnsAfterALongAbsence) {
  const Scene scene = MakeScene(300, {400}, {0.8}, [](int t, int) {
    return t >= 100 && t < 200 ? std::nan("") : 300.0 + (t < 100 ? 0.0 : 900.0);
  });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].sightings.size(), 200U);
  EXPECT_THAT(tracks[0].returns, ::testing::ElementsAre(200));
  EXPECT_THAT(FollowLog(scene), AllOf(HasSubstr("1 person seen, in 200 of 300 frames"),
                                      HasSubstr("appears at frame 200"), Not(HasSubstr("lost"))));
}

TEST(TrackPeople, APersonReturnsToTheSamePlaceAmongOthers) {
  const Scene scene = MakeScene(300, {400, 400}, {0.8, 0.7}, [](int t, int p) {
    return p == 0 && t >= 100 && t < 200 ? std::nan("") : 300.0 + 900.0 * p;
  });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{0, 300}));
  EXPECT_EQ(CountPeople(scene, tracks[1]), (std::array<int, 2>{200, 0}));
}

TEST(TrackPeople, TwoPeopleWhoReturnKeepTheirIdentities) {
  const Scene scene = MakeScene(300, {400, 400}, {0.8, 0.7},
                                [](int t, int p) { return t >= 100 && t < 200 ? std::nan("") : 300.0 + 1200.0 * p; });
  const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{200, 0}));
}

TEST(TrackPeople, AnUncertainReturnIsNotJoinedButReported) {
  // A similar person is present while the one followed leaves, and the next one to appear does so elsewhere.
  const Scene scene = MakeScene(300, {600, 400}, {0.8, 0.7}, [](int t, int p) {
    if (p == 1) return t >= 100 && t < 240 ? 2500.0 : std::nan("");
    return t >= 140 && t < 220 ? std::nan("") : 300.0 + (t < 140 ? 0.0 : 1200.0);
  });
  EXPECT_EQ(TrackPeople(scene.camera).size(), 3U);
  EXPECT_THAT(FollowLog(scene),
              AllOf(HasSubstr("in 140 of 300 frames"), HasSubstr("cam: 80 frames (220 to 299) are lost")));
}

TEST(TrackPeople, AFalseDetectionIsNotTakenForThePersonReturning) {
  const Scene scene = MakeScene(300, {400, 100}, {0.8, 0.3},
                                [](int t, int p) { return (p == 0) == (t < 150) ? 300.0 + 100.0 * p : std::nan(""); });
  EXPECT_EQ(TrackPeople(scene.camera).size(), 2U);
  EXPECT_THAT(FollowLog(scene), Not(HasSubstr("lost")));
}

TEST(TrackPeople, SomebodyElseInAnAbsenceIsNotThePerson) {
  // At the same place but of another size; at the same size but elsewhere.
  for (const auto& [height, x] : {std::pair(210.0, 300.0), std::pair(420.0, 900.0)}) {
    const Scene scene = MakeScene(200, {400, height}, {0.8, 0.8}, [x = x](int t, int p) {
      if (p == 0) return t >= 80 && t < 130 ? std::nan("") : 300.0;
      return t >= 85 && t < 125 ? x : std::nan("");
    });
    const std::vector<PersonTrack> tracks = TrackPeople(scene.camera);
    ASSERT_EQ(tracks.size(), 2U) << height;
    EXPECT_EQ(CountPeople(scene, tracks[0]), (std::array<int, 2>{150, 0})) << height;
    EXPECT_THAT(FollowLog(scene),
                AllOf(HasSubstr("cam: the person followed is away while somebody else is seen (frames "
                                "85 to 124)"),
                      Not(HasSubstr("suddenly"))));
  }
}

TEST(TrackPeople, SomebodyElseForGoodIsNotThePerson) {
  const Scene scene = MakeScene(200, {400, 400}, {0.8, 0.8},
                                [](int t, int p) { return (p == 0) == (t < 120) ? 300.0 + 900.0 * p : std::nan(""); });
  EXPECT_EQ(TrackPeople(scene.camera).size(), 2U);
  EXPECT_THAT(FollowLog(scene), HasSubstr("warning: cam: 80 frames (120 to 199) are lost"));
}

TEST(TrackPeople, AJumpIsReported) {
  const auto scene_with = [](double jump, int absent) {
    return MakeScene(100, {400}, {0.8}, [=](int t, int) {
      return t >= 50 && t < 50 + absent ? std::nan("") : 300.0 + t + (t < 50 ? 0.0 : jump);
    });
  };
  EXPECT_THAT(FollowLog(scene_with(190.0, 0)), HasSubstr("warning: cam: at frame 50 the person followed is suddenly"));
  EXPECT_THAT(FollowLog(scene_with(200.0, 5)), HasSubstr("at frame 55"));
  EXPECT_THAT(FollowLog(scene_with(0.0, 5)), Not(HasSubstr("suddenly")));
  EXPECT_THAT(FollowLog(scene_with(60.0, 5)), Not(HasSubstr("suddenly")));
}

TEST(FollowPerson, TakesTheMostProminentOrTheRequestedPerson) {
  const TemporaryFolder folder;
  const Scene scene = MakeScene(50, {300, 500}, {0.5, 0.8}, [](int t, int p) { return 300.0 + 400.0 * p + t; });
  KeypointClip clip;
  {
    const LogFile log(folder / "log");
    clip = FollowPerson(scene.camera, 1);
  }
  EXPECT_THAT(ReadFile(folder / "log"),
              AllOf(HasSubstr("cam: 2 people seen; following the most prominent, in 50 of 50 frames"),
                    Not(HasSubstr("`person`"))));
  EXPECT_NEAR(clip.keypoints[1], 250.0F, 10.0F);
  EXPECT_NEAR(FollowPerson(scene.camera, 2).keypoints[1], 350.0F, 10.0F);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FollowPerson(scene.camera, 3); }),
              HasSubstr("somewhere: expected 3 people in camera cam, found 2"));
}

TEST(FollowPerson, ACloseChoiceIsAWarning) {
  const TemporaryFolder folder;
  const Scene scene = MakeScene(50, {400, 380}, {0.8, 0.7}, [](int t, int p) { return 300.0 + 400.0 * p + t; });
  {
    const LogFile log(folder / "log");
    FollowPerson(scene.camera, 1);
  }
  EXPECT_THAT(ReadFile(folder / "log"), HasSubstr("set `person` cam=2"));
}

TEST(FollowPerson, FramesWithoutThePersonStayMissing) {
  const Scene scene = MakeScene(10, {400}, {0.8}, [](int t, int) { return t == 4 ? std::nan("") : 300.0; });
  const KeypointClip clip = FollowPerson(scene.camera, 1);
  ASSERT_EQ(clip.frame_count(), 10);
  for (std::size_t t = 0; t < 10; ++t) {
    EXPECT_EQ(std::isnan(clip.keypoints[t * kKeypoints * 2]), t == 4);
    EXPECT_EQ(clip.confidence[t * kKeypoints] == 0.0F, t == 4);
  }
}

TEST(FollowPerson, FollowsTheMainPersonOfEverySample) {
  const DetectionFormat& format = FindDetectionFormat("alphapose");
  for (const CameraInput& input : format.find_cameras(TestData("detections/alphapose"))) {
    DetectedCamera camera = format.read(input);
    for (const bool has_ids : {true, false}) {
      const PersonTrack track = TrackPeople(camera).front();
      // The ids of the sample are the truth, whether the tracker sees them or not.
      const DetectedCamera truth = format.read(input);
      for (const PersonTrack::Sighting& sighting : track.sightings) {
        const DetectedFrame& frame = truth.frames[static_cast<std::size_t>(sighting.frame)];
        EXPECT_EQ(frame.people[static_cast<std::size_t>(sighting.person)].track_id, 1) << has_ids;
      }
      for (DetectedFrame& frame : camera.frames) {
        for (DetectedPerson& person : frame.people) person.track_id.reset();
      }
    }
  }
}

TEST(FollowPerson, FollowsTheBalancingPersonInEveryFrame) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing");
  const DetectionFormat& format = FindDetectionFormat("openpose");
  for (const CameraInput& input : format.find_cameras(Shared("data/balancing"))) {
    const DetectedCamera camera = format.read(input);
    EXPECT_EQ(TrackPeople(camera).front().sightings.size(), 100U) << input.name;
  }
}

}  // namespace
}  // namespace canonpose
