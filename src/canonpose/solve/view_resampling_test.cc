#include "canonpose/solve/view_resampling.h"

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using testing::Hide;
using testing::MakeExactRig;

/// A capture in which all keypoints move as a polynomial of the second degree in time.
CaptureObservations Parabolas() {
  CaptureObservations capture = MakeExactRig({.frames = 20, .clips = 2}).capture;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int v = 0; v < capture.view_count(); ++v) {
      for (int j = 0; j < capture.joint_count(); ++j) {
        const std::size_t i = capture.Index(n, v, j);
        const double t = n % 20 - 10.0;
        capture.xy[2 * i] = static_cast<float>(0.01 * j + 0.02 * t - 0.001 * t * t);
        capture.xy[2 * i + 1] = static_cast<float>(0.002 * t * t + 0.01 * v);
        capture.confidence[i] = static_cast<float>(0.5 + 0.02 * (n % 20));
      }
    }
  }
  return capture;
}

TEST(ResampleView, TheIdentityKeepsEveryBit) {
  const CaptureObservations recorded = Parabolas();
  CaptureObservations capture = recorded;
  ResampleView(recorded, 1, 2, {}, capture);
  EXPECT_TRUE(HasSameKeypoints(recorded, capture));
  EXPECT_EQ(recorded.start, capture.start);
}

TEST(ResampleView, FollowsSmoothMotionBetweenFrames) {
  const CaptureObservations recorded = Parabolas();
  CaptureObservations capture = recorded;
  // Frame t of the view shows what the others show in 1.25 t + 2.5.
  const TimeMap time{1.25, 2.5};
  ResampleView(recorded, 1, 2, time, capture);
  for (int n = 0; n < 20; ++n) {
    const double own = (n - 2.5) / 1.25;
    EXPECT_EQ(capture.Sees(20 + n, 2, 3), own >= 0.0 && own <= 19.0) << n;
    if (own < 1.0 || own > 18.0) continue;
    const double t = own - 10.0;
    EXPECT_NEAR(capture.At(20 + n, 2, 3).x(), 0.03 + 0.02 * t - 0.001 * t * t, 1e-6);
    EXPECT_NEAR(capture.At(20 + n, 2, 3).y(), 0.002 * t * t + 0.02, 1e-6);
    EXPECT_NEAR(capture.confidence[capture.Index(20 + n, 2, 3)], 0.5 + 0.02 * own, 1e-5);
    EXPECT_TRUE(capture.HasStart(20 + n, 2));
    EXPECT_NEAR(capture.StartOf(20 + n, 2).norm(), 1.0, 1e-5);
  }
  CopyView(recorded, 2, capture);
  EXPECT_TRUE(HasSameKeypoints(recorded, capture)) << "other views and clips are left alone";
}

TEST(ResampleView, MakesNothingUpForFramesWithoutDetection) {
  CaptureObservations recorded = Parabolas();
  Hide(recorded, 10, 0, 4);
  CaptureObservations capture = recorded;
  ResampleView(recorded, 0, 0, {1.0, 0.5}, capture);
  for (int n = 1; n < 20; ++n) {
    EXPECT_EQ(capture.Sees(n, 0, 4), n != 10 && n != 11) << n;
    EXPECT_TRUE(capture.Sees(n, 0, 5));
    if (n < 2 || n > 18 || n == 10 || n == 11) continue;
    const double t = n - 10.5;
    // Beside the gap only a line is known.
    EXPECT_NEAR(capture.At(n, 0, 4).y(), 0.002 * t * t, n == 9 || n == 12 ? 6e-4 : 1e-6) << n;
  }
}

}  // namespace
}  // namespace canonpose
