#include "canonpose/simulate/simulator.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/geometry/camera.h"
#include "canonpose/simulate/statistics.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

SimulationOptions Small(const std::string& rig = "studio") {
  SimulationOptions options;
  options.activities = {Activity::kGait, Activity::kDance};
  options.subjects = 2;
  options.seconds = 1.0;
  options.fps = 20.0;
  options.rig.kind = rig;
  options.seed = 5;
  return options;
}

std::vector<SimulatedClip> AllClips(const Simulator& simulator, int threads) {
  std::vector<SimulatedClip> clips;
  ClipStream stream(simulator, threads);
  while (std::optional<SimulatedClip> clip = stream.Next()) clips.push_back(std::move(*clip));
  return clips;
}

/// Equality for which NaN equals NaN.
bool SameValues(const std::vector<float>& a, const std::vector<float>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

class NoiseFree : public ::testing::TestWithParam<std::string> {};

TEST_P(NoiseFree, KeypointsAreTheProjectionsOfTheTruth) {
  SimulationOptions options = Small(GetParam());
  options.detector.noise = 0.0;
  options.rig.distortion = 1.0;
  const Simulator simulator(options);
  int seen = 0;
  for (const SimulatedClip& clip : AllClips(simulator, 2)) {
    for (const CameraView& view : clip.sequence.cameras) {
      for (std::size_t i = 0; i < view.confidence.size(); ++i) {
        const int frame = static_cast<int>(i) / simulator.skeleton().joint_count();
        if (view.confidence[i] == 0.0F) continue;
        ++seen;
        ASSERT_EQ(view.confidence[i], 1.0F);
        const Camera& camera = view.CalibrationAt(frame);
        const float* const truth = &view.truth.positions()[3 * i];
        const Eigen::Vector2d pixel = camera.ProjectFromCamera({truth[0], truth[1], truth[2]});
        ASSERT_NEAR(view.keypoints[2 * i], pixel.x(), 2e-3) << view.name;
        ASSERT_NEAR(view.keypoints[2 * i + 1], pixel.y(), 2e-3) << view.name;
      }
    }
  }
  EXPECT_GT(seen, 4 * 20 * 4 * 17 * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Rigs, NoiseFree, ::testing::Values("studio", "ring", "ptz", "handheld"));

TEST(Simulator, SameSeedSameBitsWhateverTheThreads) {
  const std::vector<SimulatedClip> one = AllClips(Simulator(Small()), 1);
  const std::vector<SimulatedClip> three = AllClips(Simulator(Small()), 3);
  ASSERT_EQ(one.size(), 4U);
  ASSERT_EQ(three.size(), 4U);
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(one[n].sequence.name, three[n].sequence.name);
    for (std::size_t c = 0; c < one[n].sequence.cameras.size(); ++c) {
      EXPECT_TRUE(SameValues(one[n].sequence.cameras[c].keypoints, three[n].sequence.cameras[c].keypoints));
      EXPECT_TRUE(
          SameValues(one[n].sequence.cameras[c].truth.positions(), three[n].sequence.cameras[c].truth.positions()));
    }
  }
  SimulationOptions other = Small();
  other.seed = 6;
  EXPECT_FALSE(SameValues(Simulator(other).Make(0).sequence.cameras[0].truth.positions(),
                          one[0].sequence.cameras[0].truth.positions()));
}

TEST(Simulator, AClipDoesNotDependOnOtherClips) {
  SimulationOptions more = Small();
  more.subjects = 3;
  EXPECT_TRUE(SameValues(Simulator(more).Make(3).sequence.cameras[1].keypoints,
                         Simulator(Small()).Make(3).sequence.cameras[1].keypoints));
}

TEST(Simulator, ClipsOfASubjectShareTheirCamerasOthersDoNot) {
  const std::vector<SimulatedClip> clips = AllClips(Simulator(Small()), 2);
  const auto camera = [&](int clip) { return clips[static_cast<std::size_t>(clip)].sequence.cameras[0].calibration; };
  EXPECT_EQ(clips[0].sequence.capture, clips[1].sequence.capture);
  EXPECT_NE(clips[0].sequence.capture, clips[2].sequence.capture);
  EXPECT_TRUE(clips[0].sequence.static_cameras);
  EXPECT_EQ(camera(0)[0].camera_from_world_rotation, camera(1)[0].camera_from_world_rotation);
  EXPECT_NE(camera(0)[0].camera_from_world_rotation, camera(2)[0].camera_from_world_rotation);
  // Different cameras are different captures, even in different files.
  SimulationOptions farther = Small();
  farther.rig.distance_m = 7.0;
  EXPECT_NE(Simulator(farther).Make(0).sequence.capture, clips[0].sequence.capture);
  EXPECT_FALSE(Simulator(Small("ptz")).Make(0).sequence.static_cameras);
}

TEST(Simulator, TheSubjectStandsUprightAndFacesEveryWay) {
  SimulationOptions options = Small();
  options.activities = {Activity::kGait};
  options.subjects = 12;
  options.detector.noise = 0.0;
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  const auto at = [&](const char* joint) { return static_cast<std::size_t>(skeleton.Find(joint).value()); };
  int facing = 0;
  int away = 0;
  for (const SimulatedClip& clip : AllClips(Simulator(options), 2)) {
    const float* truth = clip.sequence.cameras[0].truth.positions().data();
    EXPECT_LT(truth[3 * at("Head") + 1], truth[3 * at("Hip") + 1]) << "y points down";
    EXPECT_LT(truth[3 * at("Hip") + 1], truth[3 * at("LFoot") + 1]);
    // A person who faces the camera has the left hip on the right of the image and the nose in front of the thorax.
    const bool left_is_right = truth[3 * at("LHip")] > truth[3 * at("RHip")];
    const bool nose_is_near = truth[3 * at("Nose") + 2] < truth[3 * at("Thorax") + 2];
    if (left_is_right && nose_is_near) ++facing;
    if (!left_is_right && !nose_is_near) ++away;
  }
  EXPECT_GT(facing, 1);
  EXPECT_GT(away, 1);
  EXPECT_GT(facing + away, 8);
}

TEST(Simulator, ALayoutIsMappedAsByImport) {
  SimulationOptions options = Small();
  options.layout = "body_25b";
  options.detector.noise = 0.0;
  const Simulator simulator(options);
  EXPECT_EQ(simulator.source().layout, "body_25b");
  const SimulatedClip clip = simulator.Make(0);
  const CameraView& view = clip.sequence.cameras[0];
  const Skeleton& layout = *FindSkeleton("body_25b");
  const auto hip = static_cast<std::size_t>(simulator.skeleton().Find("Hip").value());
  const auto left = static_cast<std::size_t>(layout.Find("LHip").value());
  const auto right = static_cast<std::size_t>(layout.Find("RHip").value());
  EXPECT_NEAR(view.keypoints[2 * hip],
              (clip.detections[0].keypoints[2 * left] + clip.detections[0].keypoints[2 * right]) / 2, 1e-3);
  // A derived joint lies between its sources, and so does its truth.
  const auto thigh = static_cast<std::size_t>(simulator.skeleton().Find("LHip").value());
  const auto other = static_cast<std::size_t>(simulator.skeleton().Find("RHip").value());
  const std::vector<float>& truth = view.truth.positions();
  EXPECT_NEAR(truth[3 * hip], (truth[3 * thigh] + truth[3 * other]) / 2, 1e-2);
}

class DetectorOnPeople : public ::testing::TestWithParam<std::string> {};

TEST_P(DetectorOnPeople, HasTheErrorsOfModernDetectors) {
  SimulationOptions options = Small(GetParam());
  options.activities = AllActivities();
  options.subjects = 3;
  options.seconds = 8.0;
  options.fps = 25.0;
  const Simulator simulator(options);
  DetectorStatistics statistics(simulator.layout());
  ClipStream clips(simulator, 2);
  while (const std::optional<SimulatedClip> clip = clips.Next()) {
    for (std::size_t c = 0; c < clip->cameras.size(); ++c) {
      statistics.Add(clip->track, clip->cameras[c], clip->detections[c]);
    }
  }
  const double median = statistics.Percentile(-1, 50);
  EXPECT_GT(median, 1.0);
  EXPECT_LT(median, 1.5);
  // A heavy tail: a normal error's 99th percentile (Rayleigh) is 2.6 times its median.
  EXPECT_GT(statistics.Percentile(-1, 99), 6.0 * median);
  EXPECT_GT(statistics.Percentile(-1, 95), 4.0);
  EXPECT_LT(statistics.Percentile(-1, 95), 9.0);
  const Skeleton& skeleton = simulator.skeleton();
  EXPECT_GT(statistics.Percentile(*skeleton.Find("LWrist"), 50),
            1.3 * statistics.Percentile(*skeleton.Find("LHip"), 50));
  EXPECT_GT(statistics.ConfidenceAuc(), 0.70);
  EXPECT_LT(statistics.ConfidenceAuc(), 0.80);
  EXPECT_LT(statistics.ConfidenceCorrelation(), -0.3);
  EXPECT_GT(statistics.Share(kSwapped), 0.004);
  EXPECT_LT(statistics.Share(kSwapped), 0.03);
  EXPECT_GT(statistics.Share(kOccluded), 0.05);
  EXPECT_LT(statistics.Share(kMissed), 0.05);
  EXPECT_LT(statistics.Share(kOutsideImage), 0.08) << "people leave the picture";
}

INSTANTIATE_TEST_SUITE_P(Rigs, DetectorOnPeople, ::testing::Values("studio", "ring", "ptz", "handheld"));

TEST(Simulator, MotionCaptureAtALowerRateKeepsItsLimbs) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  SimulationOptions options = Small();
  options.motion_files = {testing::Shared("data/cmu/02/02_01.amc")};
  options.fps = 30.0;
  const SimulatedClip clip = Simulator(options).Make(0);
  EXPECT_EQ(clip.sequence.name, "02_01");
  EXPECT_EQ(clip.sequence.subject, "02");
  EXPECT_EQ(clip.sequence.fps, 30.0);
  options.fps = 0.0;
  const SimulatedClip full = Simulator(options).Make(0);
  EXPECT_EQ(full.sequence.fps, 120.0);
  EXPECT_EQ(clip.sequence.frame_count, (full.sequence.frame_count + 3) / 4);
  for (int t = 0; t < clip.track.frame_count(); ++t) {
    const double thigh = (clip.track.At(t, kLHip) - clip.track.At(t, kLKnee)).norm();
    ASSERT_NEAR(thigh, (full.track.At(0, kLHip) - full.track.At(0, kLKnee)).norm(), 1.0);
  }
}

TEST(Simulator, NumbersOutOfRangeAreBadInput) {
  const auto error = [](auto change) {
    SimulationOptions options = Small();
    change(options);
    return ErrorOf(ErrorKind::kBadInput, [&] { const Simulator simulator(options); });
  };
  EXPECT_THAT(error([](SimulationOptions& o) { o.subjects = -1; }), HasSubstr("`subjects`"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.clips = -3; }), HasSubstr("`clips`"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.seconds = -1; }), HasSubstr("`seconds`"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.seconds = 1e9; }), HasSubstr("more clips"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.fps = -1; }), HasSubstr("`fps`"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.rig.cameras = -4; }), HasSubstr("cameras"));
  EXPECT_THAT(error([](SimulationOptions& o) { o.motion_files = {"/nowhere/at/all.bvh"}; }), HasSubstr("nowhere"));
  SimulationOptions options = Small();
  options.skeleton = "spider";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { const Simulator simulator(options); }), HasSubstr("h36m-17"));
}

}  // namespace
}  // namespace canonpose
