#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <Eigen/Dense>

#include "canonpose/base/error.h"
#include "canonpose/lift/lifter.h"

namespace canonpose {
namespace {

/// Weights w such that w . y is the value at time 0 of the quadratic that fits values y at times `t` best.
Eigen::VectorXd QuadraticWeights(const Eigen::VectorXd& t) {
  Eigen::MatrixXd powers(t.size(), 3);
  powers << Eigen::VectorXd::Ones(t.size()), t, t.array().square().matrix();
  return (powers.transpose() * powers).ldlt().solve(powers.transpose()).row(0).transpose();
}

}  // namespace

void Smooth(LiftedPoses& poses, int window_frames) {
  const std::vector<std::int64_t>& frames = poses.frames;
  CANONPOSE_CHECK(window_frames >= kMinSmoothing && std::ssize(frames) == poses.frame_count(), "{} {}", window_frames,
                  frames.size());
  const int half = window_frames / 2;
  const auto values = static_cast<std::size_t>(3 * poses.joint_count());
  const std::vector<float> before = poses.pose_in_camera.positions();
  for (int t = 0; t < poses.frame_count(); ++t) {
    const auto at = static_cast<std::size_t>(t);
    if (!std::isfinite(before[at * values])) continue;
    std::vector<std::size_t> near;
    for (int n = std::max(0, t - half); n <= std::min(poses.frame_count() - 1, t + half); ++n) {
      const auto other = static_cast<std::size_t>(n);
      if (std::isfinite(before[other * values]) && std::abs(frames[other] - frames[at]) <= half) near.push_back(other);
    }
    // With hardly more than three frames, a quadratic passes through the values and smooths nothing.
    if (near.size() < static_cast<std::size_t>(kMinSmoothing)) continue;
    Eigen::VectorXd times(static_cast<Eigen::Index>(near.size()));
    for (std::size_t i = 0; i < near.size(); ++i) {
      times[static_cast<Eigen::Index>(i)] = static_cast<double>(frames[near[i]] - frames[at]);
    }
    const Eigen::VectorXd weights = QuadraticWeights(times);
    for (std::size_t k = 0; k < values; ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < near.size(); ++i)
        sum += weights[static_cast<Eigen::Index>(i)] * before[near[i] * values + k];
      poses.pose_in_camera.positions()[at * values + k] = static_cast<float>(sum);
    }
    using Rotation = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    const Eigen::Map<const Rotation> rotation(&poses.rotation[9 * at]);
    poses.canonical.PoseAt(t) = poses.pose_in_camera.PoseAt(t) * rotation;
  }
}

}  // namespace canonpose
