#include "canonpose/evaluate/metrics.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

using Pose = std::vector<float>;

constexpr int kJoints = 17;

Pose RandomPose(Rng& rng, double size_mm = 300.0) {
  Pose pose(3 * kJoints);
  for (float& value : pose) value = static_cast<float>(size_mm * rng.Normal());
  return pose;
}

Pose Transformed(const Pose& pose, double scale, const Eigen::Matrix3d& matrix, const Eigen::Vector3d& shift) {
  Pose result(pose.size());
  for (std::size_t i = 0; i < pose.size(); i += 3) {
    const Eigen::Vector3d point(pose[i], pose[i + 1], pose[i + 2]);
    const Eigen::Vector3d moved = scale * matrix * point + shift;
    for (int axis = 0; axis < 3; ++axis) result[i + static_cast<std::size_t>(axis)] = static_cast<float>(moved[axis]);
  }
  return result;
}

PoseErrors Compare(const Pose& predicted, const Pose& truth) {
  return ComparePoses(predicted.data(), truth.data(), MetricJoints::All(static_cast<int>(truth.size() / 3), 0));
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST(MetricsTest, ScaleAdjustmentByHand) {
  // Root at (1, 1, 1) and (0, 0, 0). Centred: P = e1, e2, e3, 2e1; G = 10 e1, 20 e2, 10 e3, 20 e1.
  const Pose predicted = {1, 1, 1, 2, 1, 1, 1, 2, 1, 1, 1, 2, 3, 1, 1};
  const Pose truth = {0, 0, 0, 10, 0, 0, 0, 20, 0, 0, 0, 10, 20, 0, 0};
  // s = (10 + 20 + 10 + 40) / (1 + 1 + 1 + 4) = 80 / 7.
  const double s = 80.0 / 7.0;
  const PoseErrors errors = Compare(predicted, truth);
  ASSERT_EQ(errors.outcome, PoseOutcome::kEvaluated);
  EXPECT_NEAR(errors.scaled_mm[0], 0.0, 1e-9);
  EXPECT_NEAR(errors.scaled_mm[1], s - 10.0, 1e-9);
  EXPECT_NEAR(errors.scaled_mm[2], 20.0 - s, 1e-9);
  EXPECT_NEAR(errors.scaled_mm[3], s - 10.0, 1e-9);
  EXPECT_NEAR(errors.scaled_mm[4], 2.0 * s - 20.0, 1e-9);
}

TEST(MetricsTest, PckAucAndCpsByHand) {
  PoseErrors a;
  a.outcome = PoseOutcome::kEvaluated;
  a.scaled_mm = {0.0, 150.0, 149.0, 12.0};
  a.aligned_mm = {0.0, 100.0, 50.0, 10.0};
  PoseErrors b = a;
  b.aligned_mm = {0.0, 310.0, 0.0, 0.0};
  MetricSum sum;
  sum.Add(a);
  sum.Add(b);
  const Metrics mean = sum.Mean();
  EXPECT_EQ(mean.poses, 2);
  EXPECT_DOUBLE_EQ(mean.n_mpjpe_mm, 311.0 / 4.0);
  EXPECT_DOUBLE_EQ(mean.p_mpjpe_mm, 470.0 / 8.0);
  EXPECT_DOUBLE_EQ(mean.pck_percent, 75.0) << "150 mm off is not below 150 mm";
  // Of the thresholds 0, 5, ..., 150, 30 exceed 0, none exceeds 150, one exceeds 149, and 28 (15 to 150) exceed 12.
  EXPECT_DOUBLE_EQ(mean.auc_percent, 100.0 * (30 + 0 + 1 + 28) / (4 * 31));
  EXPECT_DOUBLE_EQ(mean.cps, (200.0 + 0.0) / 2.0);
}

TEST(MetricsTest, CurvesAreFractionsBelowEachThreshold) {
  PoseErrors a;
  a.outcome = PoseOutcome::kEvaluated;
  a.scaled_mm = {0.0, 299.5, 150.0, 700.0};
  a.aligned_mm = {0.0, 10.0, 9.0, 0.5};
  PoseErrors b = a;
  b.aligned_mm = {0.0, 310.0, 0.0, 0.0};
  MetricSum sum;
  sum.Add(a);
  sum.Add(b);
  const Metrics mean = sum.Mean();
  ASSERT_EQ(mean.pck_curve_percent.size(), 300U);
  ASSERT_EQ(mean.cps_curve_percent.size(), 300U);
  EXPECT_DOUBLE_EQ(mean.pck_curve_percent[0], 25.0);
  EXPECT_DOUBLE_EQ(mean.pck_curve_percent[149], 25.0) << "150 mm off is not below 150 mm";
  EXPECT_DOUBLE_EQ(mean.pck_curve_percent[150], 50.0);
  EXPECT_DOUBLE_EQ(mean.pck_curve_percent[299], 75.0);
  EXPECT_DOUBLE_EQ(mean.cps_curve_percent[9], 0.0);
  EXPECT_DOUBLE_EQ(mean.cps_curve_percent[10], 50.0);
  EXPECT_DOUBLE_EQ(mean.cps_curve_percent[299], 50.0);
}

TEST(MetricsTest, PckCountsOnlyTheGivenJoints) {
  PoseErrors errors;
  errors.outcome = PoseOutcome::kEvaluated;
  errors.scaled_mm = {0.0, 90.0, 110.0, NAN};
  errors.aligned_mm = {0.0, 1.0, 2.0, NAN};
  MetricSum sum({100.0, {false, true, true, true}});
  sum.Add(errors);
  const Metrics mean = sum.Mean();
  EXPECT_DOUBLE_EQ(mean.pck_percent, 50.0) << "the root is not counted, the last joint unknown";
  EXPECT_DOUBLE_EQ(mean.n_mpjpe_mm, 200.0 / 3.0) << "over all joints nevertheless";
  EXPECT_TRUE(std::isnan(mean.joints[3].n_mpjpe_mm));
  EXPECT_DOUBLE_EQ(mean.joints[2].p_mpjpe_mm, 2.0);
  const PoseMeans of_pose = MeansOf(errors);
  EXPECT_DOUBLE_EQ(of_pose.n_mpjpe_mm, 200.0 / 3.0);
  EXPECT_DOUBLE_EQ(of_pose.p_mpjpe_mm, 1.0);
  EXPECT_DOUBLE_EQ(of_pose.largest_aligned_mm, 2.0);
}

TEST(MetricsTest, GroupsHaveEqualWeightsWhateverTheirSize) {
  PoseErrors good;
  good.outcome = PoseOutcome::kEvaluated;
  good.scaled_mm = {0.0, 10.0};
  good.aligned_mm = {5.0, 5.0};
  PoseErrors bad = good;
  bad.scaled_mm = {NAN, 200.0};
  bad.aligned_mm = {NAN, 100.0};
  MetricSum often;
  for (int i = 0; i < 9; ++i) often.Add(good);
  MetricSum once;
  once.Add(bad);
  const Metrics mean = AverageOf({often.Mean(), once.Mean()});
  EXPECT_EQ(mean.poses, 10);
  EXPECT_DOUBLE_EQ(mean.n_mpjpe_mm, (5.0 + 200.0) / 2.0);
  EXPECT_DOUBLE_EQ(mean.p_mpjpe_mm, (5.0 + 100.0) / 2.0);
  EXPECT_DOUBLE_EQ(mean.pck_percent, 50.0);
  EXPECT_DOUBLE_EQ(mean.cps, (295.0 + 200.0) / 2.0);
  EXPECT_DOUBLE_EQ(mean.cps_curve_percent[50], 50.0);
  EXPECT_DOUBLE_EQ(mean.joints[0].p_mpjpe_mm, 5.0) << "only the first group knows it";
  EXPECT_DOUBLE_EQ(mean.joints[1].p_mpjpe_mm, 52.5);
}

TEST(MetricsTest, CpsIsTheAreaUnderTheFractionOfCorrectPoses) {
  Rng rng(1);
  MetricSum sum;
  std::vector<double> largest_mm;
  for (int i = 0; i < 200; ++i) {
    const Pose truth = RandomPose(rng);
    Pose predicted = truth;
    const double noise_mm = rng.Uniform(10.0, 150.0);
    for (float& value : predicted) value += static_cast<float>(noise_mm * rng.Normal());
    const PoseErrors errors = Compare(predicted, truth);
    sum.Add(errors);
    largest_mm.push_back(*std::max_element(errors.aligned_mm.begin(), errors.aligned_mm.end()));
  }
  double area = 0.0;
  constexpr double kStepMm = 0.01;
  for (int step = 0; step < 30'000; ++step) {
    const double threshold = (0.5 + step) * kStepMm;
    const auto correct = std::count_if(largest_mm.begin(), largest_mm.end(), [&](double e) { return e < threshold; });
    area += kStepMm * static_cast<double>(correct) / static_cast<double>(largest_mm.size());
  }
  EXPECT_NEAR(sum.Mean().cps, area, 0.02);
}

TEST(MetricsTest, InvariantToWhatTheyShouldBe) {
  Rng rng(2);
  for (int i = 0; i < 20; ++i) {
    const Pose truth = RandomPose(rng);
    const Pose predicted = RandomPose(rng);
    const PoseErrors before = Compare(predicted, truth);
    const Eigen::Matrix3d rotation =
        Eigen::Quaterniond(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal()).normalized().toRotationMatrix();
    const PoseErrors scaled =
        Compare(Transformed(predicted, 0.003, Eigen::Matrix3d::Identity(), {0.5, -1.0, 2.0}), truth);
    const PoseErrors rotated = Compare(Transformed(predicted, 2.0, rotation, {10.0, 20.0, 30.0}), truth);
    EXPECT_NEAR(Mean(scaled.scaled_mm), Mean(before.scaled_mm), 0.01);
    EXPECT_NEAR(Mean(scaled.aligned_mm), Mean(before.aligned_mm), 0.01);
    EXPECT_NEAR(Mean(rotated.aligned_mm), Mean(before.aligned_mm), 0.01);
    EXPECT_GT(std::abs(Mean(rotated.scaled_mm) - Mean(before.scaled_mm)), 0.1) << "N-MPJPE must see a rotation";
  }
}

TEST(MetricsTest, APerfectPoseHasNoErrorAndAMirroredPoseALargeOne) {
  Rng rng(3);
  const Pose truth = RandomPose(rng);
  const PoseErrors perfect = Compare(Transformed(truth, 0.01, Eigen::Matrix3d::Identity(), {1.0, 2.0, 3.0}), truth);
  EXPECT_LT(Mean(perfect.scaled_mm), 1e-2);
  EXPECT_LT(Mean(perfect.aligned_mm), 1e-2);
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
  const PoseErrors mirrored = Compare(Transformed(truth, 1.0, mirror, {0.0, 0.0, 0.0}), truth);
  EXPECT_GT(Mean(mirrored.aligned_mm), 100.0);
}

TEST(MetricsTest, DepthsAreComparedAfterScalingByTheImagePlaneAlone) {
  Rng rng(7);
  const Pose truth = RandomPose(rng);
  const MetricJoints joints = MetricJoints::All(kJoints, 0);
  for (const double stretch : {1.0, 2.5, -2.5}) {
    const Eigen::Matrix3d deeper = 0.01 * Eigen::Vector3d(1.0, 1.0, stretch).asDiagonal();
    const Pose predicted = Transformed(truth, 1.0, deeper, {1.0, 2.0, 3.0});
    const DepthSquares depths = CompareDepths(predicted.data(), truth.data(), joints);
    EXPECT_NEAR(std::sqrt(depths.predicted / depths.truth), std::abs(stretch), 1e-3);
  }
}

TEST(MetricsTest, UnknownJointsAreIgnored) {
  Rng rng(4);
  const Pose truth = RandomPose(rng);
  const Pose predicted = RandomPose(rng);
  Pose partly = truth;
  partly[3 * 5 + 1] = NAN;
  Pose without = predicted;
  without[3 * 5] = 1e6F;  // any value
  const PoseErrors errors = Compare(without, partly);
  ASSERT_EQ(errors.outcome, PoseOutcome::kEvaluated);
  EXPECT_TRUE(std::isnan(errors.scaled_mm[5]));
  EXPECT_TRUE(std::isnan(errors.aligned_mm[5]));

  // The same as if the joint did not exist, and as if it were left out.
  Pose short_truth = truth;
  Pose short_predicted = predicted;
  short_truth.erase(short_truth.begin() + 15, short_truth.begin() + 18);
  short_predicted.erase(short_predicted.begin() + 15, short_predicted.begin() + 18);
  const PoseErrors expected = Compare(short_predicted, short_truth);
  MetricJoints joints = MetricJoints::All(kJoints, 0);
  joints.included[5] = false;
  const PoseErrors left_out = ComparePoses(predicted.data(), truth.data(), joints);
  EXPECT_DOUBLE_EQ(errors.scaled_mm[6], expected.scaled_mm[5]);
  EXPECT_DOUBLE_EQ(errors.aligned_mm[16], expected.aligned_mm[15]);
  EXPECT_DOUBLE_EQ(left_out.aligned_mm[16], expected.aligned_mm[15]);
  without[3 * 5] = NAN;
  EXPECT_EQ(Compare(without, partly).outcome, PoseOutcome::kEvaluated);
}

TEST(MetricsTest, PosesThatCannotBeEvaluatedSayWhy) {
  Rng rng(5);
  const Pose truth = RandomPose(rng);
  Pose broken = truth;
  broken[0] = NAN;
  EXPECT_EQ(Compare(truth, broken).outcome, PoseOutcome::kTruthUnusable) << "no root";
  EXPECT_EQ(Compare(broken, truth).outcome, PoseOutcome::kPredictionMissing);
  broken = truth;
  broken[50] = NAN;
  EXPECT_EQ(Compare(broken, truth).outcome, PoseOutcome::kPredictionMissing);
  broken[50] = INFINITY;
  EXPECT_EQ(Compare(broken, truth).outcome, PoseOutcome::kPredictionMissing);
  broken = truth;
  std::fill(broken.begin() + 3 * 9, broken.end(), NAN);
  EXPECT_EQ(Compare(truth, broken).outcome, PoseOutcome::kEvaluated) << "9 of 17";
  broken[3 * 8] = NAN;
  EXPECT_EQ(Compare(truth, broken).outcome, PoseOutcome::kTruthUnusable) << "8 of 17";
}

TEST(MetricsTest, MinKnownJoints) {
  EXPECT_EQ(MinKnownJoints(17), 9);
  EXPECT_EQ(MinKnownJoints(16), 8);
  EXPECT_EQ(MinKnownJoints(5), 4);
  EXPECT_EQ(MinKnownJoints(2), 2);
}

TEST(MetricsTest, NothingAddedIsNaN) {
  EXPECT_TRUE(std::isnan(MetricSum().Mean().n_mpjpe_mm));
  EXPECT_TRUE(std::isnan(MetricSum().Mean().cps));
}

}  // namespace
}  // namespace canonpose
