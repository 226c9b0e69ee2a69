#include "canonpose/solve/time_offset.h"

#include <gtest/gtest.h>

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using testing::MakeExactRig;

struct Recording {
  ExactRig rig;
  Solution solution;
};

/// With errors of the usual size, or nothing would limit what is believed.
Recording Film(int views, int frames = 100) {
  ExactRigOptions options;
  options.views = views;
  options.frames = frames;
  Recording recording{MakeExactRig(options), {}};
  testing::SeeJoints(recording.rig.truth, 0.004, 5, recording.rig.capture);
  recording.solution.estimate = recording.rig.truth;
  return recording;
}

class Delays : public ::testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(Delays, AreFoundInOneView) {
  const auto [views, frames] = GetParam();
  Recording recording = Film(views);
  ShiftView(recording.rig.capture, 0, 1, frames);
  const OffsetEstimate found = EstimateOffset(recording.rig.capture, recording.solution, 0, 1, false);
  EXPECT_EQ(found.frames, -frames);
  EXPECT_GT(found.gain, 0.0);
}

INSTANTIATE_TEST_SUITE_P(EstimateOffset, Delays,
                         ::testing::Combine(::testing::Values(2, 4), ::testing::Values(-9, 3, 12)));

TEST(EstimateOffset, LeavesCamerasInStepAlone) {
  for (const int views : {2, 4}) {
    Recording recording = Film(views);
    const OffsetEstimate found = EstimateOffset(recording.rig.capture, recording.solution, 0, 1, false);
    EXPECT_EQ(found.frames, 0) << views;
    EXPECT_EQ(found.gain, 0.0) << views;
  }
}

TEST(EstimateOffset, IsExactBetweenTheOffsetsThatCamerasAreEstimatedAt) {
  for (const int frames : {-4, -2, 2, 5}) {
    Recording recording = Film(4);
    ShiftView(recording.rig.capture, 0, 1, frames);
    EXPECT_EQ(EstimateOffset(recording.rig.capture, recording.solution, 0, 1, false).frames, -frames);
  }
}

TEST(EstimateOffset, SaysNothingOfShortClipsAndUnknownCameras) {
  Recording brief = Film(4, 21);
  ShiftView(brief.rig.capture, 0, 1, 4);
  EXPECT_EQ(EstimateOffset(brief.rig.capture, brief.solution, 0, 1, false).frames, 0);
  Recording unknown = Film(4);
  ShiftView(unknown.rig.capture, 0, 1, 4);
  unknown.solution.estimate.CameraAt(0, 1).valid = false;
  EXPECT_EQ(EstimateOffset(unknown.rig.capture, unknown.solution, 0, 1, false).frames, 0);
}

}  // namespace
}  // namespace canonpose
