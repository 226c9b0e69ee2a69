#include "canonpose/solve/rig_estimate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

/// One person of four joints before two moving cameras, far enough away that perspective is a thousandth.
RigEstimate SeenFromAfar() {
  constexpr double kLogFocal = 7.0;
  RigEstimate estimate = RigEstimate::Unknown(false, 1, 2, 4, 1);
  const Eigen::Vector3d joints[] = {{0, 0, 0}, {0.1, -0.3, 0.2}, {-0.2, 0.4, -0.1}, {0.3, 0.1, 0.25}};
  std::copy(std::begin(joints), std::end(joints), estimate.joints.begin());
  for (int view = 0; view < 2; ++view) {
    CameraEstimate& camera = estimate.CameraAt(0, view);
    camera.SetRotation(Eigen::AngleAxisd(0.4 + view, Eigen::Vector3d(0.2, 1.0, 0.1).normalized()).toRotationMatrix());
    camera.placement = {0.05, -0.02, -1.0};
    camera.log_focal = kLogFocal;
    camera.valid = true;
  }
  return estimate;
}

TEST(RigEstimate, TheDepthMirrorLooksTheSameFromAfar) {
  const RigEstimate estimate = SeenFromAfar();
  RigEstimate mirror = estimate;
  mirror.MirrorDepth();
  for (int view = 0; view < 2; ++view) {
    for (int joint = 0; joint < 4; ++joint) {
      EXPECT_LT((mirror.Project(0, view, joint) - estimate.Project(0, view, joint)).norm(), 1e-3) << view << joint;
    }
    const Eigen::Vector3d before = estimate.InCamera(0, view, 3) - estimate.InCamera(0, view, 0);
    const Eigen::Vector3d after = mirror.InCamera(0, view, 3) - mirror.InCamera(0, view, 0);
    EXPECT_LT((after - before.cwiseProduct(Eigen::Vector3d(1, 1, -1))).norm(), 1e-12);
    EXPECT_GT(std::abs(before.z()), 0.1);
  }
}

TEST(RigEstimate, TheMirrorOfTheMirrorIsTheFirst) {
  const RigEstimate estimate = SeenFromAfar();
  RigEstimate twice = estimate;
  twice.MirrorDepth();
  twice.MirrorDepth();
  for (int view = 0; view < 2; ++view) {
    EXPECT_TRUE(twice.CameraAt(0, view).Rotation().isApprox(estimate.CameraAt(0, view).Rotation(), 1e-12));
  }
  EXPECT_EQ(twice.joints, estimate.joints);
}

}  // namespace
}  // namespace canonpose
