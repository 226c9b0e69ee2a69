#include "canonpose/solve/resection.h"

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

constexpr int kView = 1;
constexpr double kScatter = 0.003;

std::vector<Sighting> SightingsOf(const testing::ExactRig& rig, int frames) {
  std::vector<Sighting> sightings;
  for (int n = 0; n < frames; ++n) {
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      sightings.push_back({rig.truth.Joint(n, j), rig.capture.At(n, kView, j)});
    }
  }
  return sightings;
}

void ExpectCamera(const Resection& found, const testing::ExactRig& rig, double tolerance) {
  ASSERT_TRUE(found.valid);
  const CameraEstimate& camera = rig.truth.CameraAt(0, kView);
  EXPECT_LT((found.rotation - camera.Rotation()).norm(), tolerance);
  EXPECT_LT((found.translation - rig.truth.Translation(0, kView)).norm(), 3.0 * tolerance);
}

TEST(Resect, IsExactOfExactKeypoints) {
  const testing::ExactRig rig = testing::MakeExactRig();
  const Resection found = Resect(SightingsOf(rig, 20), rig.truth.CameraAt(0, kView).log_focal, kScatter);
  ExpectCamera(found, rig, 0.01);
  EXPECT_LT(found.cost, 0.1);
  EXPECT_NEAR(found.StaticCamera().log_focal, rig.truth.CameraAt(0, kView).log_focal, 1e-12);
}

TEST(Resect, FindsTheFocalLength) {
  const testing::ExactRig rig = testing::MakeExactRig();
  const double focal = rig.truth.CameraAt(0, kView).log_focal;
  for (const double expected : {focal - 0.4, focal, focal + 0.3}) {
    const Resection found = ResectWithFocal(SightingsOf(rig, 20), expected, kScatter);
    ExpectCamera(found, rig, 0.1);
    EXPECT_NEAR(found.log_focal, focal, 0.08) << expected;
  }
}

TEST(Resect, WrongKeypointsCountLittle) {
  const testing::ExactRig rig = testing::MakeExactRig();
  std::vector<Sighting> sightings = SightingsOf(rig, 20);
  for (std::size_t i = 0; i < sightings.size(); i += 4) sightings[i].keypoint += Eigen::Vector2d(0.2, -0.1);
  ExpectCamera(Resect(sightings, rig.truth.CameraAt(0, kView).log_focal, kScatter), rig, 0.02);
}

TEST(Resect, NeedsEnoughJointsThatDoNotLieInAPlane) {
  const testing::ExactRig rig = testing::MakeExactRig();
  std::vector<Sighting> sightings = SightingsOf(rig, 1);
  EXPECT_FALSE(Resect(std::span(sightings).first(5), 0.0, kScatter).valid);
  for (Sighting& sighting : sightings) sighting.joint.z() = 0.1;
  EXPECT_FALSE(Resect(sightings, 0.0, kScatter).valid);
}

TEST(Resection, NothingIsSeenBehindTheCamera) {
  Resection camera;
  EXPECT_TRUE(std::isinf(camera.ErrorOf({{0.0, 0.0, -1.0}, {0.0, 0.0}})));
  EXPECT_NEAR(camera.ErrorOf({{0.1, 0.0, 2.0}, {0.0, 0.0}}), 0.1, 1e-12);
}

}  // namespace
}  // namespace canonpose
