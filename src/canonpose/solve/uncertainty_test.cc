#include "canonpose/solve/uncertainty.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/base/median.h"
#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;

constexpr double kNoise = 0.004;
constexpr int kJoint = 6;

/// A rig in which every joint is where its keypoints show it, and which knows their scatter.
struct Triangulated {
  ExactRig rig;
  Solution solution;

  explicit Triangulated(const ExactRigOptions& options) : rig(testing::MakeExactRig(options)) {
    testing::SeeJoints(rig.truth, kNoise, 31, rig.capture);
    Triangulate();
  }
  void Triangulate() {
    solution.estimate = rig.truth;
    solution.scales.observation = NoiseModel(kNoise);
    for (int round = 0; round < 2; ++round) {
      for (int n = 0; n < rig.capture.frame_count; ++n) {
        for (int j = 0; j < rig.capture.joint_count(); ++j) {
          solution.estimate.Joint(n, j) = TriangulateJoint(rig.capture, n, j, solution.scales, rig.truth).point;
        }
      }
      const std::vector<int> frames = ConsecutiveFrames(0, rig.capture.frame_count);
      solution.scales.observation = MeasureNoise(rig.capture, frames, solution.estimate);
    }
  }
  [[nodiscard]] std::size_t Index(int frame, int joint) const {
    return static_cast<std::size_t>(frame * rig.capture.joint_count() + joint);
  }
};

/// The median of a joint over some frames.
double MedianOf(const Triangulated& in, const std::vector<double>& uncertainty, int joint, int first, int count) {
  std::vector<double> values;
  for (const int n : ConsecutiveFrames(first, count)) values.push_back(uncertainty[in.Index(n, joint)]);
  return Median(std::move(values));
}

/// Root mean squares of the errors of all joints along an axis and of what is said of them.
std::array<double, 2> TrueAndSaid(const Triangulated& in) {
  const std::vector<double> uncertainty = MeasureUncertainty(in.rig.capture, in.solution);
  double squares = 0.0;
  double said = 0.0;
  const double count = static_cast<double>(uncertainty.size());
  for (std::size_t i = 0; i < uncertainty.size(); ++i) {
    squares += (in.solution.estimate.joints[i] - in.rig.truth.joints[i]).squaredNorm() / (3.0 * count);
    said += uncertainty[i] * uncertainty[i] / count;
  }
  return {std::sqrt(squares), std::sqrt(said)};
}

TEST(MeasureUncertainty, FollowsTheScatterOfTriangulatedJointsWhateverTheNumberOfViews) {
  for (const int views : {3, 4, 6}) {
    ExactRigOptions options;
    options.frames = 200;
    options.views = views;
    const auto [is, said] = TrueAndSaid(Triangulated(options));
    RecordProperty("ratio_of_" + std::to_string(views), std::to_string(said / is));
    // Without smoothness, bones and cameras' errors, which the factors stand for.
    EXPECT_NEAR(said / is, 0.64, 0.12) << views;
  }
}

TEST(MeasureUncertainty, IsLargeWhereViewsDisagree) {
  ExactRigOptions options;
  options.frames = 200;
  Triangulated in(options);
  constexpr int kFirst = 100;
  constexpr int kCount = 40;
  const std::vector<double> usual = MeasureUncertainty(in.rig.capture, in.solution);
  for (int n = kFirst; n < kFirst + kCount; ++n) {
    const std::size_t i = 2 * in.rig.capture.Index(n, 1, kJoint);
    in.rig.capture.xy[i] += static_cast<float>(6.0 * kNoise * in.rig.truth.ImageScale(n, 1, 0));
    in.rig.capture.xy[i + 1] += static_cast<float>(6.0 * kNoise * in.rig.truth.ImageScale(n, 1, 0));
  }
  in.Triangulate();
  const std::vector<double> now = MeasureUncertainty(in.rig.capture, in.solution);
  // Its errors grow by 38 %, since the other three views agree.
  EXPECT_GT(MedianOf(in, now, kJoint, kFirst, kCount), 1.2 * MedianOf(in, usual, kJoint, kFirst, kCount));
  // Neither other joints nor other times.
  EXPECT_NEAR(MedianOf(in, now, 3, kFirst, kCount) / MedianOf(in, usual, 3, kFirst, kCount), 1.0, 0.15);
  EXPECT_NEAR(MedianOf(in, now, kJoint, 0, 80) / MedianOf(in, usual, kJoint, 0, 80), 1.0, 0.25);
}

TEST(MeasureUncertainty, IsVeryLargeWhereTheOnlyTwoViewsOfAJointDisagree) {
  ExactRigOptions options;
  options.frames = 200;
  Triangulated in(options);
  constexpr int kFirst = 100;
  constexpr int kCount = 40;
  for (int n = 0; n < 200; ++n) {
    for (const int v : {0, 1}) testing::Hide(in.rig.capture, n, v, kJoint);
    if (n < kFirst || n >= kFirst + kCount) continue;
    // Upwards, where the other view sees it, too.
    const std::size_t i = 2 * in.rig.capture.Index(n, 2, kJoint);
    in.rig.capture.xy[i + 1] += static_cast<float>(15.0 * kNoise * in.rig.truth.ImageScale(n, 2, 0));
  }
  in.Triangulate();
  const std::vector<double> found = MeasureUncertainty(in.rig.capture, in.solution);
  EXPECT_GT(MedianOf(in, found, kJoint, kFirst, kCount), 3.0 * MedianOf(in, found, kJoint, 0, 80));
}

TEST(MeasureUncertainty, GrowsWhereFewerViewsSeeAJoint) {
  ExactRigOptions options;
  options.frames = 60;
  Triangulated in(options);
  const double usual = MedianOf(in, MeasureUncertainty(in.rig.capture, in.solution), kJoint, 0, 60);
  for (int n = 0; n < 60; ++n) {
    for (const int v : {0, 1}) testing::Hide(in.rig.capture, n, v, kJoint);
  }
  in.Triangulate();
  const double of_two = MedianOf(in, MeasureUncertainty(in.rig.capture, in.solution), kJoint, 0, 60);
  EXPECT_GT(of_two, 1.15 * usual);  // its errors grow by 37 %
  for (int n = 0; n < 60; ++n) testing::Hide(in.rig.capture, n, 2, kJoint);
  for (int n = 0; n < 60; ++n) in.solution.estimate.Joint(n, kJoint) = in.rig.truth.Joint(n, kJoint);
  const double of_one = MedianOf(in, MeasureUncertainty(in.rig.capture, in.solution), kJoint, 0, 60);
  EXPECT_GT(of_one, 3.0 * of_two);
  EXPECT_LT(of_one, 0.2);  // its bones hold it
}

TEST(MeasureUncertainty, OfWhatNoViewSeesComesFromItsNeighboursInTime) {
  ExactRigOptions options;
  options.frames = 60;
  Triangulated in(options);
  in.solution.scales.acceleration.assign(static_cast<std::size_t>(in.rig.capture.joint_count()), 0.001);
  for (int v = 0; v < in.rig.capture.view_count(); ++v) testing::Hide(in.rig.capture, 30, v, kJoint);
  const std::vector<double> found = MeasureUncertainty(in.rig.capture, in.solution);
  EXPECT_GT(found[in.Index(30, kJoint)], found[in.Index(29, kJoint)]);
  EXPECT_LT(found[in.Index(30, kJoint)], 10.0 * kNoise);
  EXPECT_TRUE(std::isfinite(found[in.Index(30, kJoint)]));
}

TEST(MeasureUncertainty, IsUnknownWhereAJointIs) {
  ExactRigOptions options;
  options.frames = 20;
  Triangulated in(options);
  in.solution.estimate.Joint(4, kJoint).setConstant(std::nan(""));
  const std::vector<double> found = MeasureUncertainty(in.rig.capture, in.solution);
  for (int n = 0; n < 20; ++n) EXPECT_EQ(std::isnan(found[in.Index(n, kJoint)]), n == 4) << n;
}

}  // namespace
}  // namespace canonpose
