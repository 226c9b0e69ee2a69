#include "canonpose/solve/synchronisation.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/solver.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;

constexpr double kFine = 100.0;  // frames per second

/// One clip of 30 s by four cameras, at 100 frames per second, and start poses.
struct FineRecording {
  Dataset dataset;
  StartPoses start;
};

const FineRecording& Fine() {
  static const FineRecording recording = [] {
    SimulationOptions options = testing::SmallSimulation();
    options.activities = {Activity::kDance};
    options.clips = 1;
    options.seconds = 24.0;
    options.fps = kFine;
    FineRecording fine;
    fine.dataset = testing::Simulate(options).dataset;
    fine.start = testing::NoisyTruth(fine.dataset);
    return fine;
  }();
  return recording;
}

/// What a camera recorded of it: `seconds` from `begin` on, at `fps`.
struct Cut {
  double begin = 0.0;
  double seconds = 12.0;
  double fps = 25.0;
};

template <typename Value>
std::vector<Value> CutRows(const std::vector<Value>& rows, const Cut& cut, int frames, Value missing) {
  const std::size_t width = rows.size() / static_cast<std::size_t>(Fine().dataset.sequences[0].frame_count);
  std::vector<Value> kept(static_cast<std::size_t>(frames) * width, missing);
  for (int t = 0; t < frames; ++t) {
    const long from = std::lround((cut.begin + t / cut.fps) * kFine);
    if (t >= cut.seconds * cut.fps || from >= Fine().dataset.sequences[0].frame_count) break;
    std::copy_n(rows.begin() + from * static_cast<long>(width), width, kept.begin() + t * static_cast<long>(width));
  }
  return kept;
}

/// The recording as cameras made it that nobody synchronised. Frames are at those of the first cut's rate.
FineRecording Unsynchronised(const std::vector<Cut>& cuts, FrameTiming timing = FrameTiming::kOwn) {
  FineRecording recording = Fine();
  Sequence& sequence = recording.dataset.sequences[0];
  int frames = 0;
  for (const Cut& cut : cuts) frames = std::max(frames, static_cast<int>(cut.seconds * cut.fps));
  sequence.fps = cuts.front().fps;
  sequence.timing = timing;
  for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
    CameraView& view = sequence.cameras[c];
    view.keypoints = CutRows(view.keypoints, cuts[c], frames, std::nanf(""));
    view.confidence = CutRows(view.confidence, cuts[c], frames, 0.0F);
    view.truth = {};
    PoseSequence& start = recording.start.sequences[0][c];
    start = PosesAboutRoot(recording.dataset.skeleton, CutRows(start.positions(), cuts[c], frames, std::nanf("")),
                           view.name);
  }
  sequence.frame_count = frames;
  return recording;
}

Synchronisation Found(const FineRecording& recording, const GivenOffsets& given = {}) {
  CaptureObservations capture = CollectCaptures(recording.dataset, recording.start).front();
  return Synchronise(capture, given, [](const CaptureObservations& some) {
    CalibrationOptions options;
    options.frames = 120;
    options.max_iterations = 25;
    return CalibrateStatic(some, options);
  });
}

TEST(Synchronise, FindsWhenEachCameraBegan) {
  const std::vector<Cut> cuts = {{4.0}, {0.37}, {7.15}, {2.62}};
  const Synchronisation found = Found(Unsynchronised(cuts));
  ASSERT_EQ(found.failure, "");
  ASSERT_EQ(found.clocks.size(), 4U);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_NE(found.clocks[v].source, ClockSource::kUnknown) << found.clocks[v].reason;
    const double offset = found.clocks[v].offset_seconds - found.clocks[0].offset_seconds;
    EXPECT_NEAR(offset, cuts[v].begin - cuts[0].begin, 0.02) << v;
    EXPECT_LT(found.clocks[v].deviation_seconds, 0.01);
    EXPECT_EQ(found.clocks[v].time.rate, 1.0);
  }
}

TEST(Synchronise, FindsAnotherRateWhereNoneIsKnown) {
  // Of equally numbered frames, so that those of the second camera, 50 per second, seem to last twice as long.
  const std::vector<Cut> cuts = {{2.0}, {3.5, 12.0, 50.0}, {0.5}, {1.0}};
  FineRecording recording = Unsynchronised(cuts);
  recording.dataset.sequences[0].fps = 0.0;
  const Synchronisation found = Found(recording);
  ASSERT_EQ(found.failure, "");
  const TimeMap& first = found.clocks[0].time;
  const TimeMap& second = found.clocks[1].time;
  EXPECT_NEAR(second.rate / first.rate, 0.5, 1e-3);
  // Its frame 0 shows what the first one's frame 37.5 does.
  EXPECT_NEAR((second.offset - first.offset) / first.rate, 37.5, 0.5);
}

TEST(Synchronise, LeavesOutWhatDoesNotTell) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  const std::vector<Cut> cuts = {{4.0}, {0.36}, {7.16}, {2.6}};
  FineRecording recording = Unsynchronised(cuts);
  // A camera that shows a person who stands still.
  CameraView& view = recording.dataset.sequences[0].cameras[2];
  const std::size_t row = view.keypoints.size() / static_cast<std::size_t>(recording.dataset.sequences[0].frame_count);
  for (std::size_t i = row; i < view.keypoints.size(); ++i) view.keypoints[i] = view.keypoints[i % row];
  const Synchronisation found = Found(recording);
  ASSERT_EQ(found.failure, "");
  EXPECT_EQ(found.clocks[2].source, ClockSource::kUnknown);
  EXPECT_NE(found.clocks[2].reason, "");
  EXPECT_NEAR(found.clocks[1].offset_seconds - found.clocks[0].offset_seconds, -3.64, 0.02);
}

TEST(Synchronise, NothingIsDoneWhereFramesBelongTogether) {
  const FineRecording recording = Unsynchronised({{1.0}, {1.0}, {1.0}, {1.0}}, FrameTiming::kCommon);
  const CaptureObservations recorded = CollectCaptures(recording.dataset, recording.start).front();
  CaptureObservations capture = recorded;
  const Synchronisation found = Synchronise(capture, {}, [](const CaptureObservations&) { return Solution(); });
  EXPECT_TRUE(found.clocks.empty());
  EXPECT_TRUE(HasSameKeypoints(recorded, capture));
  EXPECT_TRUE(found.times[0][3].IsIdentity());
}

TEST(Synchronise, DoubtKeepsWhatWasRecordedTogether) {
  const Synchronisation found = Found(Unsynchronised({{1.0}, {1.0}, {1.0}, {1.0, 11.0}}, FrameTiming::kUnsure));
  for (const ViewClockEstimate& clock : found.clocks) {
    EXPECT_NEAR(clock.offset_seconds, 0.0, 0.004);
  }
}

TEST(Synchronise, GivenOffsetsAreTakenAsTheyAre) {
  const Synchronisation found =
      Found(Unsynchronised({{4.0}, {0.36}, {7.16}, {2.6}}), {{"cam3", 3.16}, {"cam2", -3.64}, {"cam4", -1.4}});
  ASSERT_EQ(found.clocks.size(), 4U);
  for (const ViewClockEstimate& clock : found.clocks) {
    const double expected = clock.camera == "cam1"   ? 0.0
                            : clock.camera == "cam2" ? -3.64
                            : clock.camera == "cam3" ? 3.16
                                                     : -1.4;
    EXPECT_NEAR(clock.offset_seconds, expected, 1e-12) << clock.camera;
  }
}

TEST(Solve, WritesTheClocksOfUnsynchronisedCameras) {
  FineRecording recording = Unsynchronised({{4.0}, {0.37}, {5.13}, {2.62}});
  const SolveReport report = Solve(recording.dataset, recording.start, {});
  const Sequence& sequence = recording.dataset.sequences[0];
  const double first = sequence.cameras[0].time_offset_seconds;
  EXPECT_NEAR(sequence.cameras[1].time_offset_seconds - first, -3.63, 0.02);
  EXPECT_NEAR(sequence.cameras[2].time_offset_seconds - first, 1.13, 0.02);
  EXPECT_LT(report.captures[0].reprojection_percent, 0.7);
  EXPECT_THAT(report.ToText(), HasSubstr("the others are synchronised with it"));
  EXPECT_THAT(report.ToJson(), HasSubstr("\"uncertainty_seconds\""));
}

TEST(ParseOffset, TakesANameAndSeconds) {
  EXPECT_EQ(ParseOffset("cam3=1.25"), (std::pair<std::string, double>("cam3", 1.25)));
  EXPECT_EQ(ParseOffset("a=b=-2").first, "a=b");
  for (const char* text : {"", "cam3", "=1", "cam3=", "cam3=1s", "cam3=nan"}) {
    EXPECT_THAT(testing::ErrorOf(ErrorKind::kInvalidArgument, [&] { ParseOffset(text); }), HasSubstr("`offset`"));
  }
}

TEST(SolveOptions, OffsetsAreOfCamerasOfTheData) {
  SolveOptions options;
  options.offsets = {{"nobody", 1.0}};
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kInvalidArgument, [&] { options.RequireCamerasOf(Fine().dataset); }),
              HasSubstr("found nobody"));
}

}  // namespace
}  // namespace canonpose
