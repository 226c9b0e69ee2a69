#include "canonpose/scene/up_solver.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

using Evidence = UpSolver::Evidence;

/// z, tilted by some degrees towards x.
Eigen::Vector3d Tilted(double degrees) { return {std::sin(RadFromDeg(degrees)), 0.0, std::cos(RadFromDeg(degrees))}; }

double TiltDeg(const UpSolver::Result& result) { return DegFromRad(std::atan2(result.up.x(), result.up.z())); }

TEST(UpSolver, WeighsByInverseVariance) {
  UpSolver solver;
  solver.AddUpward(Evidence::kPeople, Tilted(0.0), RadFromDeg(1.0));
  solver.AddUpward(Evidence::kPeople, Tilted(1.0), RadFromDeg(2.0));
  const UpSolver::Result result = solver.Solve(Tilted(30.0));
  EXPECT_NEAR(TiltDeg(result), 0.2, 0.01);
  EXPECT_NEAR(result.up.y(), 0.0, 1e-9);
  // Two directions, each with the variance 1 / (1 + 1/4).
  EXPECT_NEAR(DegFromRad(result.deviation_rad), std::sqrt(2.0 / 1.25), 0.05);
}

TEST(UpSolver, LevelAxesAndAFloorEachFixOneDirection) {
  UpSolver solver;
  solver.AddLevel(Evidence::kCameras, Eigen::Vector3d(1, 0, 0), RadFromDeg(1.0));
  for (const double y : {-1.0, 0.0, 1.0}) solver.AddFloor({0.0, y, 5.0}, 2.0, 0.01);
  const UpSolver::Result result = solver.Solve(Eigen::Vector3d(0.2, 0.3, 1.0));
  EXPECT_NEAR(result.up.z(), 1.0, 1e-9);
  EXPECT_NEAR(result.floor, 3.0, 1e-6);
  // The slope along y is known to 0.01 / sqrt(2), the height to 0.01 / sqrt(3).
  EXPECT_NEAR(result.deviation_rad, std::hypot(RadFromDeg(1.0), 0.01 / std::sqrt(2.0)), 1e-4);
  EXPECT_NEAR(result.floor_deviation, 0.01 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(result.shares[0] + result.shares[2], 1.0, 1e-6);
  EXPECT_GT(result.shares[2], result.shares[0]);
}

TEST(UpSolver, AnOutlierCountsLittle) {
  UpSolver solver;
  for (int i = 0; i < 3; ++i) solver.AddUpward(Evidence::kPeople, Tilted(0.0), RadFromDeg(1.0));
  solver.AddUpward(Evidence::kCameras, Tilted(60.0), RadFromDeg(1.0));
  EXPECT_LT(std::abs(TiltDeg(solver.Solve(Tilted(5.0)))), 0.1);
}

TEST(UpSolver, PointsAtOnePlaceSayNothingOfTheDirection) {
  UpSolver solver;
  solver.AddUpward(Evidence::kPeople, Tilted(3.0), RadFromDeg(5.0));
  for (int i = 0; i < 5; ++i) solver.AddFloor({0.0, 0.0, 4.0}, 0.0, 0.001);
  const UpSolver::Result result = solver.Solve(Tilted(0.0));
  EXPECT_NEAR(TiltDeg(result), 3.0, 1e-3);
  EXPECT_LT(result.shares[2], 0.01);
}

}  // namespace
}  // namespace canonpose
