#include "canonpose/solve/view_signs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using ::testing::Each;
using ::testing::Property;

struct Watched {
  testing::ExactRig rig;
  Solution solution;
};

Watched WatchExactRig() {
  testing::ExactRigOptions options;
  options.frames = 100;
  Watched watched{testing::MakeExactRig(options), {}};
  testing::SeeJoints(watched.rig.truth, 0.003, 1, watched.rig.capture);
  watched.solution.estimate = watched.rig.truth;
  return watched;
}

/// Moves what a view sees from a frame on, by so much of the body.
void Push(const RigEstimate& truth, int view, int first, double distance, CaptureObservations& capture) {
  for (int n = first; n < capture.frame_count; ++n) {
    const double scale = truth.ImageScale(n, view, capture.skeleton.root);
    for (int j = 0; j < capture.joint_count(); ++j) {
      capture.xy[2 * capture.Index(n, view, j)] += static_cast<float>(distance * scale);
    }
  }
}

TEST(ViewSigns, GoodViewsRaiseNoAlarm) {
  const Watched watched = WatchExactRig();
  const std::vector<ViewSigns> signs = MeasureSigns(watched.rig.capture, watched.solution);
  EXPECT_THAT(signs, Each(Property(&ViewSigns::Alarm, false)));
  for (const ViewSigns& view : signs) EXPECT_LT(view.largest_step, 0.003);
}

TEST(ViewSigns, APushedCameraHasAStepEvenWhereTheCalibrationIsACompromise) {
  Watched watched = WatchExactRig();
  constexpr double kPush = 0.02;
  // The camera's solution lies between its two positions.
  Push(watched.rig.truth, 1, 0, -kPush / 2, watched.rig.capture);
  Push(watched.rig.truth, 1, 60, kPush, watched.rig.capture);
  const std::vector<ViewSigns> signs = MeasureSigns(watched.rig.capture, watched.solution);
  // A part of the distance is what the other views, of which there are three, do not know.
  EXPECT_GT(signs[1].largest_step, 0.6 * kPush);
  EXPECT_LT(signs[1].largest_step, 1.1 * kPush);
  EXPECT_LT(signs[1].disagreement, 0.012);
  EXPECT_TRUE(signs[1].Alarm());
  EXPECT_TRUE(AnyAlarm(signs));
}

TEST(ViewSigns, MovingCamerasHaveNoStep) {
  Watched watched = WatchExactRig();
  watched.rig.capture.static_cameras = false;
  Push(watched.rig.truth, 1, 60, 0.02, watched.rig.capture);
  for (const ViewSigns& view : MeasureSigns(watched.rig.capture, watched.solution)) EXPECT_EQ(view.largest_step, 0.0);
}

}  // namespace
}  // namespace canonpose
