#include "canonpose/solve/rotation_averaging.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

Eigen::Matrix3d RandomRotation(Rng& rng) {
  return Eigen::Quaterniond(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()).normalized().toRotationMatrix();
}

Eigen::Matrix3d Near(const Eigen::Matrix3d& rotation, double scatter_rad, Rng& rng) {
  const Eigen::Vector3d turn = scatter_rad * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
  return Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * rotation;
}

TEST(RotationAngle, OfSmallAndLargeTurns) {
  for (const double angle : {1e-7, 0.3, 2.0, 3.14}) {
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 2) / 3.0).toRotationMatrix();
    EXPECT_NEAR(RotationAngle(Eigen::Matrix3d::Identity(), turned), angle, 1e-9 + 1e-6 * angle);
  }
}

TEST(RobustMean, IsExactOfEqualSamples) {
  Rng rng(1);
  const Eigen::Matrix3d truth = RandomRotation(rng);
  const std::vector<Eigen::Matrix3d> samples(5, truth);
  const MeanRotation mean = RobustMean(samples, std::vector<double>(5, 0.5));
  EXPECT_LT(RotationAngle(mean.rotation, truth), 1e-9);
  EXPECT_LT(mean.median_angle_rad, 1e-9);
  EXPECT_DOUBLE_EQ(mean.weight, 2.5);
}

TEST(RobustMean, AThirdOfOutliersHardlyMovesIt) {
  Rng rng(2);
  const Eigen::Matrix3d truth = RandomRotation(rng);
  std::vector<Eigen::Matrix3d> samples;
  for (int i = 0; i < 200; ++i) samples.push_back(Near(truth, 0.1, rng));
  for (int i = 0; i < 100; ++i) samples.push_back(RandomRotation(rng));
  EXPECT_LT(RotationAngle(RobustMean(samples, std::vector<double>(300, 1.0)).rotation, truth), 0.06);
}

TEST(RobustMean, NothingHasNoWeight) { EXPECT_EQ(RobustMean({}, {}).weight, 0.0); }

std::vector<std::vector<MeanRotation>> PairsOf(const std::vector<Eigen::Matrix3d>& camera_from_world) {
  std::vector<std::vector<MeanRotation>> pairs(camera_from_world.size(),
                                               std::vector<MeanRotation>(camera_from_world.size()));
  for (std::size_t to = 0; to < pairs.size(); ++to) {
    for (std::size_t from = 0; from < pairs.size(); ++from) {
      if (to == from) continue;
      pairs[to][from] = {camera_from_world[to] * camera_from_world[from].transpose(), 1.0, 0.1};
    }
  }
  return pairs;
}

/// The largest angle between relative rotations of the two lists.
double LargestError(const std::vector<Eigen::Matrix3d>& a, const std::vector<Eigen::Matrix3d>& b) {
  double largest = 0.0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    largest = std::max(largest, RotationAngle(a[v] * a[0].transpose(), b[v] * b[0].transpose()));
  }
  return largest;
}

TEST(SynchroniseRotations, ExactPairsGiveExactCameras) {
  Rng rng(3);
  std::vector<Eigen::Matrix3d> truth;
  for (int v = 0; v < 5; ++v) truth.push_back(RandomRotation(rng));
  EXPECT_LT(LargestError(SynchroniseRotations(PairsOf(truth)), truth), 1e-9);
}

TEST(SynchroniseRotations, AWrongPairIsOutvoted) {
  Rng rng(4);
  std::vector<Eigen::Matrix3d> truth;
  for (int v = 0; v < 6; ++v) truth.push_back(RandomRotation(rng));
  std::vector<std::vector<MeanRotation>> pairs = PairsOf(truth);
  pairs[2][4].rotation = RandomRotation(rng);
  pairs[4][2].rotation = pairs[2][4].rotation.transpose();
  EXPECT_LT(LargestError(SynchroniseRotations(pairs), truth), 0.05);
}

TEST(SynchroniseRotations, CamerasOutOfReachStayUnknown) {
  Rng rng(5);
  std::vector<Eigen::Matrix3d> truth;
  for (int v = 0; v < 3; ++v) truth.push_back(RandomRotation(rng));
  std::vector<std::vector<MeanRotation>> pairs = PairsOf(truth);
  for (int v = 0; v < 2; ++v)
    pairs[2][static_cast<std::size_t>(v)].weight = pairs[static_cast<std::size_t>(v)][2].weight = 0.0;
  const std::vector<Eigen::Matrix3d> found = SynchroniseRotations(pairs);
  EXPECT_TRUE(found[0].allFinite() && found[1].allFinite());
  EXPECT_FALSE(found[2].allFinite());
}

TEST(AlignRotation, FindsTheTurn) {
  Rng rng(6);
  Points3d pose(8, 3);
  for (Eigen::Index i = 0; i < pose.size(); ++i) pose.data()[i] = rng.Normal();
  const Eigen::Matrix3d truth = RandomRotation(rng);
  EXPECT_LT(RotationAngle(AlignRotation(pose, 3.0 * pose * truth.transpose()), truth), 1e-9);
}

}  // namespace
}  // namespace canonpose
