#include "canonpose/solve/tracklets.h"

#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "canonpose/solve/people_testing.h"

namespace canonpose {
namespace {

using testing::Crowd;
using testing::MakeCrowd;
using testing::SmallCrowd;
using testing::StartOfLanes;

/// A crowd takes a second to simulate.
const Crowd& TwoPeople() {
  static const Crowd crowd = MakeCrowd(SmallCrowd(2));
  return crowd;
}

TEST(Lanes, HoldEverySightingOnce) {
  const Crowd& crowd = TwoPeople();
  const Lanes lanes = MakeLanes(crowd.apart.skeleton, crowd.together);
  const std::size_t joints = crowd.apart.skeleton.joints.size();
  for (std::size_t v = 0; v < crowd.together.cameras.size(); ++v) {
    for (int t = 0; t < lanes.frame_count; ++t) {
      std::multiset<float> expected;
      std::multiset<float> found;
      const auto collect = [&](const std::vector<float>& keypoints, std::multiset<float>& values) {
        for (std::size_t j = 0; j < joints; ++j) {
          const float x = keypoints[2 * (static_cast<std::size_t>(t) * joints + j)];
          if (std::isfinite(x)) values.insert(x);
        }
      };
      for (const CameraTrack& track : crowd.together.cameras[v].tracks) collect(track.keypoints, expected);
      for (const Sequence& lane : lanes.dataset.sequences) collect(lane.cameras[v].keypoints, found);
      ASSERT_EQ(found, expected) << v << ' ' << t;
    }
  }
}

TEST(Lanes, AreFewAndTheirOwnersKnown) {
  const Crowd& crowd = TwoPeople();
  const Lanes lanes = MakeLanes(crowd.apart.skeleton, crowd.together);
  EXPECT_LE(lanes.lane_count, 4) << "two people, whose tracks end and begin at the same time";
  for (std::size_t i = 0; i < lanes.tracklets.size(); ++i) {
    const Tracklet& tracklet = lanes.tracklets[i];
    EXPECT_EQ(lanes.Owner(tracklet.lane, tracklet.view, tracklet.first), static_cast<int>(i));
    EXPECT_EQ(lanes.Owner(tracklet.lane, tracklet.view, tracklet.last), static_cast<int>(i));
  }
}

TEST(Lanes, ALongGapCutsATrack) {
  Crowd crowd = TwoPeople();
  const std::size_t joints = crowd.apart.skeleton.joints.size();
  CameraView& view = crowd.together.cameras.front();
  view.tracks.resize(1);
  const std::size_t before = MakeLanes(crowd.apart.skeleton, crowd.together).tracklets.size();
  for (std::size_t i = 10 * joints; i < 30 * joints; ++i) view.tracks[0].confidence[i] = 0.0F;
  EXPECT_EQ(MakeLanes(crowd.apart.skeleton, crowd.together).tracklets.size(), before + 1);
}

TEST(Person, SequenceAndStartAreThoseOfTheLanes) {
  const Crowd& crowd = TwoPeople();
  Lanes lanes = MakeLanes(crowd.apart.skeleton, crowd.together);
  const StartPoses start = StartOfLanes(crowd, lanes);
  Person person(lanes);
  for (int t = 0; t < lanes.frame_count; ++t) {
    for (int v = 0; v < lanes.view_count; ++v) {
      for (int lane = 0; lane < lanes.lane_count; ++lane) {
        if (WhoIs(crowd, lanes, lane, v, t) == 1) person.At(t, v) = lane;
      }
    }
  }
  const Sequence sequence = SequenceOf(lanes, person, crowd.together, "hall-person1");
  EXPECT_EQ(sequence.scene, "hall");
  EXPECT_EQ(sequence.subject, "hall-person1");
  EXPECT_EQ(sequence.capture, crowd.together.capture);
  for (std::size_t v = 0; v < sequence.cameras.size(); ++v) {
    EXPECT_EQ(sequence.cameras[v].confidence, crowd.apart.sequences[1].cameras[v].confidence);
    EXPECT_EQ(sequence.cameras[v].calibration.size(), 1U);
  }
  const std::vector<PoseSequence> own = StartOf(lanes, person, start);
  const PeopleObservations people = CollectPeople(std::move(lanes), start);
  ASSERT_EQ(own.size(), 4U);
  EXPECT_TRUE(own[0].AnyKnown());
  // Put together frame by frame they are what an import of this person alone gives.
  const std::vector<int> frames = person.FramesWith(2);
  const CaptureObservations assembled = AssembleCapture(people, {&person, 1}, {&frames, 1});
  Dataset alone;
  alone.skeleton = crowd.apart.skeleton;
  alone.sequences = {sequence};
  const CaptureObservations direct = CollectCaptures(alone, {{own}}).front();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (int v = 0; v < 4; ++v) {
      for (int j = 0; j < direct.joint_count(); ++j) {
        const std::size_t a = assembled.Index(static_cast<int>(i), v, j);
        const std::size_t b = direct.Index(frames[i], v, j);
        ASSERT_EQ(assembled.confidence[a], direct.confidence[b]);
        if (direct.confidence[b] > 0.0F) {
          ASSERT_EQ(assembled.xy[2 * a], direct.xy[2 * b]);
        }
        if (direct.HasStart(frames[i], v)) {
          ASSERT_EQ(assembled.start[3 * a + 2], direct.start[3 * b + 2]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace canonpose
