#include "canonpose/geometry/alignment.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

Points3d RandomPoints(Rng& rng, int count) {
  Points3d points(count, 3);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = rng.Normal();
  return points;
}

Eigen::Matrix3d RandomRotation(Rng& rng) {
  return Eigen::Quaterniond(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()).normalized().toRotationMatrix();
}

TEST(AlignmentTest, ScaleByHand) {
  Points3d from(2, 3);
  from << 1, 0, 0, 0, 2, 0;
  Points3d to(2, 3);
  to << 3, 1, 0, 0, 1, 0;
  EXPECT_DOUBLE_EQ(LeastSquaresScale(from, to), (3.0 + 2.0) / 5.0);
  EXPECT_EQ(LeastSquaresScale(Points3d::Zero(2, 3), to), 0.0);
}

TEST(AlignmentTest, FindsTheSimilarityThatMadeThePoints) {
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const Points3d from = RandomPoints(rng, 3 + i % 15);
    Similarity truth;
    truth.scale = rng.Uniform(0.1, 10.0);
    truth.rotation = RandomRotation(rng);
    truth.translation = {rng.Normal(), rng.Normal(), 100.0};
    const Similarity found = AlignSimilarity(from, truth.Apply(from));
    EXPECT_NEAR(found.scale, truth.scale, 1e-9);
    EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-7);
    EXPECT_LT((found.Apply(from) - truth.Apply(from)).norm(), 1e-8);
  }
}

TEST(AlignmentTest, IsTheBestOfItsNeighbours) {
  Rng rng(3);
  const Points3d from = RandomPoints(rng, 12);
  const Points3d to = RandomPoints(rng, 12);
  const Similarity best = AlignSimilarity(from, to);
  const double least = (best.Apply(from) - to).squaredNorm();
  for (int i = 0; i < 200; ++i) {
    Similarity other = best;
    const Eigen::Vector3d axis = Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()).normalized();
    other.rotation = Eigen::AngleAxisd(0.05 * rng.Normal(), axis).toRotationMatrix() * best.rotation;
    other.scale *= 1.0 + 0.05 * rng.Normal();
    other.translation += 0.05 * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
    EXPECT_GE((other.Apply(from) - to).squaredNorm(), least);
  }
}

TEST(AlignmentTest, NeverReflects) {
  Rng rng(4);
  const Points3d from = RandomPoints(rng, 17);
  Points3d mirrored = from;
  mirrored.col(2) *= -1.0;
  const Similarity found = AlignSimilarity(from, mirrored);
  EXPECT_NEAR(found.rotation.determinant(), 1.0, 1e-9);
  EXPECT_GT((found.Apply(from) - mirrored).rowwise().norm().mean(), 0.3);
}

TEST(AlignmentTest, PointsThatCoincideGiveTheMean) {
  Rng rng(5);
  const Points3d to = RandomPoints(rng, 4);
  const Similarity found = AlignSimilarity(Points3d::Ones(4, 3), to);
  EXPECT_EQ(found.scale, 0.0);
  EXPECT_LT((found.translation - to.colwise().mean().transpose()).norm(), 1e-12);
}

TEST(AlignmentTest, NearestRotationIsProper) {
  Rng rng(6);
  const Eigen::Matrix3d rotation = RandomRotation(rng);
  EXPECT_LT((NearestRotation(3.0 * rotation) - rotation).norm(), 1e-9);
  EXPECT_NEAR(NearestRotation(-rotation).determinant(), 1.0, 1e-9);
}

}  // namespace
}  // namespace canonpose
