#include "canonpose/solve/motion_signature.h"

#include <gtest/gtest.h>

#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/view_resampling.h"

namespace canonpose {
namespace {

/// One clip of 16 s by two cameras, with the errors of a detector and of a lifter.
CaptureObservations Recording(Activity activity) {
  SimulationOptions options = testing::SmallSimulation();
  options.activities = {activity};
  options.clips = 1;
  options.seconds = 16.0;
  options.rig.cameras = 2;
  const Dataset dataset = testing::Simulate(options).dataset;
  return CollectCaptures(dataset, testing::NoisyTruth(dataset)).front();
}

/// Keeps the frames of a view from `first` on, moved to the beginning.
CaptureObservations BeginLater(const CaptureObservations& recorded, int view, int first) {
  CaptureObservations later = recorded;
  ResampleView(recorded, 0, view, {1.0, -static_cast<double>(first)}, later);
  return later;
}

TEST(SimilarityCurve, IsHighestWhereFramesBelongTogether) {
  for (const int late : {0, 37, 200}) {
    const CaptureObservations capture = BeginLater(Recording(Activity::kDance), 1, late);
    const SimilarityCurve curve(SignatureOf(capture, 0, 0), SignatureOf(capture, 0, 1), 4.0);
    const auto peaks = curve.Peaks(3, 4.0);
    ASSERT_EQ(peaks.size(), 3U);
    EXPECT_NEAR(peaks[0].lag, late, 1.5);
    EXPECT_GT(peaks[0].value, 5.0);
    EXPECT_GT(peaks[0].value, 1.3 * peaks[1].value);
    EXPECT_NEAR(curve.At(late), peaks[0].value, 0.5 * peaks[0].value);
  }
}

TEST(SimilarityCurve, AnotherMotionIsNoMoreThanChance) {
  const CaptureObservations dance = Recording(Activity::kDance);
  const CaptureObservations reach = Recording(Activity::kReach);
  const SimilarityCurve curve(SignatureOf(dance, 0, 0), SignatureOf(reach, 0, 1), 4.0);
  const auto peaks = curve.Peaks(2, 4.0);
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_LT(peaks[0].value, 5.0);
}

TEST(MotionSignature, StretchesToAnotherRate) {
  const CaptureObservations recorded = Recording(Activity::kDance);
  // Every second frame, as of a camera of half the rate.
  CaptureObservations slow = recorded;
  ResampleView(recorded, 0, 1, {0.5, 0.0}, slow);
  const MotionSignature fast = SignatureOf(slow, 0, 0);
  const MotionSignature stretched = Stretch(SignatureOf(slow, 0, 1), 2.0);
  EXPECT_NEAR(stretched.last, fast.last, 2);
  const auto peaks = SimilarityCurve(fast, stretched, 4.0).Peaks(1, 4.0);
  ASSERT_EQ(peaks.size(), 1U);
  EXPECT_NEAR(peaks[0].lag, 0.0, 1.5);
  EXPECT_GT(peaks[0].value, 5.0);
}

TEST(MotionSignature, OfNothingKnowsNothing) {
  CaptureObservations capture = Recording(Activity::kDance);
  DropFrames(1, 0, capture.frame_count, capture);
  const MotionSignature nothing = SignatureOf(capture, 0, 1);
  EXPECT_FALSE(nothing.knows_anything());
  const SimilarityCurve curve(SignatureOf(capture, 0, 0), nothing, 4.0);
  EXPECT_EQ(curve.At(0.0), 0.0);
  EXPECT_TRUE(curve.Peaks(3, 4.0).empty());
}

}  // namespace
}  // namespace canonpose
