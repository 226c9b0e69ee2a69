#include "canonpose/solve/fit.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/median.h"
#include "canonpose/solve/rotation_averaging.h"

namespace canonpose {
namespace {

/// The median length of a normally distributed 3-vector, in units of its scatter along an axis.
constexpr double kMedianLength3 = 1.54;

/// The mean of Cauchy's loss over each frame's keypoints; NaN for frames without any.
std::vector<double> FrameCosts(const CaptureObservations& capture, std::span<const int> frames,
                               const RigEstimate& estimate, const NoiseModel& noise) {
  std::vector<double> costs;
  for (const int frame : frames) {
    double sum = 0.0;
    int count = 0;
    VisitErrors(capture, std::span(&frame, 1), estimate, [&](int n, int v, int j, double error) {
      const double scatter = noise.Scatter(j, capture.confidence[capture.Index(n, v, j)]);
      sum += CauchyLoss(error / scatter);
      ++count;
    });
    costs.push_back(sum / count);
  }
  return costs;
}

}  // namespace

NoiseModel MeasureNoise(const CaptureObservations& capture, std::span<const int> frames, const RigEstimate& estimate) {
  std::vector<KeypointError> errors;
  VisitErrors(capture, frames, estimate, [&](int n, int v, int j, double error) {
    errors.push_back({j, capture.confidence[capture.Index(n, v, j)], error});
  });
  return {std::move(errors), capture.joint_count()};
}

std::vector<double> MeasureAccelerations(const CaptureObservations& capture, const RigEstimate& estimate) {
  std::vector<double> scatter;
  for (int j = 0; j < capture.joint_count(); ++j) {
    std::vector<double> squares;
    constexpr int kSteps[] = {1, 3};
    for (const int step : kSteps) {
      std::vector<double> lengths;
      for (const ClipRange& clip : capture.clips) {
        for (int n = clip.first + step; n + step < clip.first + clip.count; ++n) {
          const double length =
              (estimate.Joint(n - step, j) - 2.0 * estimate.Joint(n, j) + estimate.Joint(n + step, j)).norm();
          if (std::isfinite(length)) lengths.push_back(length);
        }
      }
      squares.push_back(lengths.empty() ? 0.0 : std::pow(Median(std::move(lengths)), 2));
    }
    // With errors e and accelerations a (both squared): s1 = e + a, s3 = e + 3^4 a.
    const double acceleration2 = std::max((squares[1] - squares[0]) / 80.0, 0.0);
    scatter.push_back(std::max(std::sqrt(acceleration2) / kMedianLength3, 1e-5));
  }
  return scatter;
}

double MeasureAngularVelocity(const CaptureObservations& capture, std::span<const int> frames,
                              const RigEstimate& estimate) {
  constexpr double kBursts = 2.0;
  constexpr double kMin = 0.1;
  constexpr double kMax = 1.0;
  std::vector<double> speeds;
  const std::vector<int> runs = RunsOf(capture, frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double fps = capture.ClipOf(frames[i]).fps;
    const auto run_begin = static_cast<std::size_t>(std::ranges::lower_bound(runs, runs[i]) - runs.begin());
    const std::size_t step = std::min(static_cast<std::size_t>(std::lround(fps)), i - run_begin);
    if (static_cast<double>(step) < 0.5 * fps) continue;
    for (int v = 0; v < capture.view_count(); ++v) {
      const CameraEstimate& before = estimate.CameraAt(frames[i - step], v);
      const CameraEstimate& now = estimate.CameraAt(frames[i], v);
      if (!before.valid || !now.valid) continue;
      speeds.push_back(RotationAngle(before.Rotation(), now.Rotation()) * fps / static_cast<double>(step));
    }
  }
  if (speeds.empty()) return AdjustmentScales{}.angular_velocity;
  return std::clamp(kBursts * Median(std::move(speeds)) / kMedianLength3, kMin, kMax);
}

BlockMean MeanOverBlocks(const CaptureObservations& capture, std::span<const int> frames,
                         std::span<const double> values) {
  constexpr double kBlockSeconds = 0.5;
  std::vector<double> blocks;
  int block_begin = -1;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ClipRange& clip = capture.ClipOf(frames[i]);
    if (block_begin < 0 || frames[i] - block_begin > kBlockSeconds * clip.fps || clip.first > block_begin) {
      if (count > 0) blocks.push_back(sum / count);
      block_begin = frames[i];
      sum = 0.0;
      count = 0;
    }
    if (!std::isfinite(values[i])) continue;
    sum += values[i];
    ++count;
  }
  if (count > 0) blocks.push_back(sum / count);
  BlockMean result{static_cast<int>(blocks.size())};
  const auto block_count = static_cast<double>(blocks.size());
  for (const double block : blocks) result.mean += block / block_count;
  if (blocks.size() < 2) return result;
  double variance = 0.0;
  for (const double block : blocks) variance += std::pow(block - result.mean, 2) / (block_count - 1.0);
  result.variance = variance / block_count;
  return result;
}

double Preference(const CaptureObservations& capture, std::span<const int> frames, const Solution& a,
                  const Solution& b) {
  return Preference({capture, a}, {capture, b}, frames);
}

double Preference(const Explanation& a, const Explanation& b, std::span<const int> frames) {
  const NoiseModel& of_a = a.solution.scales.observation;
  const NoiseModel& of_b = b.solution.scales.observation;
  const NoiseModel& noise = of_a.Typical() < of_b.Typical() ? of_a : of_b;
  const std::vector<double> costs_of_a = FrameCosts(a.capture, frames, a.solution.estimate, noise);
  const std::vector<double> costs_of_b = FrameCosts(b.capture, frames, b.solution.estimate, noise);
  std::vector<double> differences;
  for (std::size_t i = 0; i < frames.size(); ++i) differences.push_back(costs_of_b[i] - costs_of_a[i]);
  const BlockMean difference = MeanOverBlocks(a.capture, frames, differences);
  return difference.blocks < 2 ? 0.0 : difference.mean / std::sqrt(difference.variance + 1e-12);
}

}  // namespace canonpose
