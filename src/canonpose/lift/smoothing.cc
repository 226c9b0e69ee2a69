// Poses smoothed over time: Smooth() of pose_lifter.h.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/lift/pose_lifter.h"

namespace canonpose {
namespace {

/// Weights w such that w . y is the value at time 0 of the quadratic that fits values y at times `t` best.
Eigen::VectorXd QuadraticWeights(const Eigen::VectorXd& t) {
  Eigen::MatrixXd powers(t.size(), 3);
  powers << Eigen::VectorXd::Ones(t.size()), t, t.array().square().matrix();
  return (powers.transpose() * powers).ldlt().solve(powers.transpose()).row(0).transpose();
}

}  // namespace

void RequireSmoothing(int window_frames, int frame_count) {
  if (window_frames < kMinSmoothing || window_frames % 2 == 0) {
    ThrowInvalidArgument(
        "`smooth`: expected an odd number of frames, {} or more, found {}{}", kMinSmoothing, window_frames,
        window_frames > kMinSmoothing ? fmt::format("; give {} or {}", window_frames - 1, window_frames + 1) : "");
  }
  if (window_frames > frame_count) {
    ThrowInvalidArgument("`smooth`: expected no more than the {} frames of the clip, found {}", frame_count,
                         window_frames);
  }
}

void Smooth(LiftedPoses& poses, int window_frames) {
  const std::vector<std::int64_t>& frames = poses.frames;
  CANONPOSE_CHECK(window_frames >= kMinSmoothing && std::ssize(frames) == poses.frame_count(), "{} {}", window_frames,
                  frames.size());
  const int half = window_frames / 2;
  const auto joints = static_cast<std::size_t>(poses.joint_count());
  const std::vector<float> before = poses.pose_in_camera.positions();
  const auto is_known = [&](std::size_t frame, std::size_t joint) {
    return std::isfinite(before[3 * (frame * joints + joint)]);
  };
  for (int t = 0; t < poses.frame_count(); ++t) {
    const auto at = static_cast<std::size_t>(t);
    std::vector<std::size_t> last;  // the frames that `weights` are for: mostly the same for all joints
    Eigen::VectorXd weights;
    bool is_smoothed = false;
    for (std::size_t j = 0; j < joints; ++j) {
      if (!is_known(at, j)) continue;
      std::vector<std::size_t> near;
      for (int n = std::max(0, t - half); n <= std::min(poses.frame_count() - 1, t + half); ++n) {
        const auto other = static_cast<std::size_t>(n);
        if (is_known(other, j) && std::abs(frames[other] - frames[at]) <= half) near.push_back(other);
      }
      // With hardly more than three frames, a quadratic passes through the values and smooths nothing.
      if (near.size() < static_cast<std::size_t>(kMinSmoothing)) continue;
      if (near != last) {
        Eigen::VectorXd times(static_cast<Eigen::Index>(near.size()));
        for (std::size_t i = 0; i < near.size(); ++i) {
          times[static_cast<Eigen::Index>(i)] = static_cast<double>(frames[near[i]] - frames[at]);
        }
        weights = QuadraticWeights(times);
        last = near;
      }
      is_smoothed = true;
      for (std::size_t k = 3 * j; k < 3 * (j + 1); ++k) {
        double sum = 0.0;
        for (std::size_t i = 0; i < near.size(); ++i)
          sum += weights[static_cast<Eigen::Index>(i)] * before[near[i] * 3 * joints + k];
        poses.pose_in_camera.positions()[at * 3 * joints + k] = static_cast<float>(sum);
      }
    }
    if (!is_smoothed) continue;
    using Rotation = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    const Eigen::Map<const Rotation> rotation(&poses.rotation[9 * at]);
    poses.canonical.PoseAt(t) = poses.pose_in_camera.PoseAt(t) * rotation;
  }
}

}  // namespace canonpose
