#include "canonpose/solve/rotation_averaging.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "canonpose/base/median.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

constexpr double kMinAngleRad = RadFromDeg(5.0);
constexpr int kReweightings = 10;
constexpr int kSynchronisationRounds = 50;

Eigen::Matrix3d NoRotation() { return Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()); }

/// The weight of a frame for the rotation between two views: the share of joints that both see, by confidence.
double PairWeight(const CaptureObservations& capture, int frame, int a, int b) {
  double weight = 0.0;
  for (int j = 0; j < capture.joint_count(); ++j) {
    weight += std::sqrt(static_cast<double>(capture.confidence[capture.Index(frame, a, j)]) *
                        capture.confidence[capture.Index(frame, b, j)]);
  }
  return weight / capture.joint_count();
}

/// Relative rotations of one frame, at [to * V + from] with from < to; weight 0 where one of the two poses is missing.
struct FrameRotations {
  std::vector<Eigen::Matrix3d> rotation;
  std::vector<double> weight;
};

FrameRotations RelativeRotations(const CaptureObservations& capture, int frame) {
  const int views = capture.view_count();
  FrameRotations relative{std::vector<Eigen::Matrix3d>(static_cast<std::size_t>(views * views)),
                          std::vector<double>(static_cast<std::size_t>(views * views), 0.0)};
  std::vector<Points3d> poses(static_cast<std::size_t>(views));
  for (int v = 0; v < views; ++v) {
    if (capture.HasStart(frame, v)) poses[static_cast<std::size_t>(v)] = capture.StartOf(frame, v);
  }
  for (int to = 0; to < views; ++to) {
    for (int from = 0; from < to; ++from) {
      if (poses[static_cast<std::size_t>(to)].size() == 0 || poses[static_cast<std::size_t>(from)].size() == 0)
        continue;
      const auto i = static_cast<std::size_t>(to * views + from);
      relative.rotation[i] = AlignRotation(poses[static_cast<std::size_t>(from)], poses[static_cast<std::size_t>(to)]);
      relative.weight[i] = PairWeight(capture, frame, from, to);
    }
  }
  return relative;
}

/// [to][from] for all pairs, from every `stride`-th of the frames `first` .. `last` of `relative`.
std::vector<std::vector<MeanRotation>> MeanPairs(const std::vector<FrameRotations>& relative, std::size_t first,
                                                 std::size_t last, std::size_t stride, int views) {
  std::vector<std::vector<MeanRotation>> pairs(static_cast<std::size_t>(views),
                                               std::vector<MeanRotation>(static_cast<std::size_t>(views)));
  std::vector<Eigen::Matrix3d> samples;
  std::vector<double> weights;
  for (int to = 0; to < views; ++to) {
    for (int from = 0; from < to; ++from) {
      const auto i = static_cast<std::size_t>(to * views + from);
      samples.clear();
      weights.clear();
      for (std::size_t n = first; n <= last; n += stride) {
        if (relative[n].weight[i] <= 0.0) continue;
        samples.push_back(relative[n].rotation[i]);
        weights.push_back(relative[n].weight[i]);
      }
      MeanRotation& mean = pairs[static_cast<std::size_t>(to)][static_cast<std::size_t>(from)];
      mean = RobustMean(samples, weights);
      MeanRotation& back = pairs[static_cast<std::size_t>(from)][static_cast<std::size_t>(to)];
      back = mean;
      back.rotation = mean.rotation.transpose();
    }
  }
  return pairs;
}

}  // namespace

double RotationAngle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  // |a - b|_F = sqrt(8) sin(angle / 2), which is exact for small angles where the trace is not.
  return 2.0 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0)));
}

MeanRotation RobustMean(std::span<const Eigen::Matrix3d> samples, std::span<const double> weights) {
  MeanRotation mean;
  std::vector<double> factors(samples.size(), 1.0);
  for (int round = 0; round < kReweightings && !samples.empty(); ++round) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) sum += weights[i] * factors[i] * samples[i];
    mean.rotation = NearestRotation(sum);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      factors[i] = kMinAngleRad / std::max(kMinAngleRad, RotationAngle(samples[i], mean.rotation));
    }
  }
  std::vector<double> angles;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    mean.weight += weights[i];
    angles.push_back(RotationAngle(samples[i], mean.rotation));
  }
  mean.median_angle_rad = Median(std::move(angles));
  return mean;
}

Eigen::Matrix3d AlignRotation(const Points3d& from, const Points3d& to) {
  return NearestRotation(to.transpose() * from);
}

std::vector<Eigen::Matrix3d> SynchroniseRotations(const std::vector<std::vector<MeanRotation>>& pairs) {
  const std::size_t views = pairs.size();
  std::vector<Eigen::Matrix3d> rotations(views, NoRotation());
  std::size_t root = 0;
  double most = -1.0;
  for (std::size_t v = 0; v < views; ++v) {
    double evidence = 0.0;
    for (std::size_t w = 0; w < views; ++w) evidence += pairs[v][w].weight;
    if (evidence > most) {
      most = evidence;
      root = v;
    }
  }
  std::vector<bool> reached(views, false);
  rotations[root].setIdentity();
  reached[root] = true;
  for (;;) {
    double heaviest = 0.0;
    std::size_t to = 0;
    std::size_t from = 0;
    for (std::size_t v = 0; v < views; ++v) {
      for (std::size_t w = 0; w < views; ++w) {
        if (reached[v] || !reached[w] || pairs[v][w].weight <= heaviest) continue;
        heaviest = pairs[v][w].weight;
        to = v;
        from = w;
      }
    }
    if (heaviest <= 0.0) break;
    rotations[to] = pairs[to][from].rotation * rotations[from];
    reached[to] = true;
  }
  for (int round = 0; round < kSynchronisationRounds; ++round) {
    for (std::size_t v = 0; v < views; ++v) {
      if (!reached[v] || v == root) continue;
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (std::size_t w = 0; w < views; ++w) {
        if (w == v || !reached[w] || pairs[v][w].weight <= 0.0) continue;
        const Eigen::Matrix3d sample = pairs[v][w].rotation * rotations[w];
        const double angle = std::max(kMinAngleRad, RotationAngle(sample, rotations[v]));
        // Pairs whose frames agree count more. Opposite views, for example, are hard for a lifter.
        sum += pairs[v][w].weight / (angle * std::max(kMinAngleRad, pairs[v][w].median_angle_rad)) * sample;
      }
      if (sum.squaredNorm() > 0.0) rotations[v] = NearestRotation(sum);
    }
  }
  return rotations;
}

StaticRotations AverageStaticRotations(const CaptureObservations& capture, std::span<const int> frames) {
  std::vector<FrameRotations> relative;
  relative.reserve(frames.size());
  for (const int frame : frames) relative.push_back(RelativeRotations(capture, frame));
  StaticRotations result;
  result.pairs = MeanPairs(relative, 0, relative.size() - 1, 1, capture.view_count());
  result.camera_from_world = SynchroniseRotations(result.pairs);
  return result;
}

std::vector<std::vector<Eigen::Matrix3d>> SmoothedRotations(const CaptureObservations& capture, double window_seconds) {
  // More samples per window would add nothing.
  constexpr int kMaxSamples = 31;
  std::vector<FrameRotations> relative;
  for (int n = 0; n < capture.frame_count; ++n) relative.push_back(RelativeRotations(capture, n));
  std::vector<std::vector<Eigen::Matrix3d>> rotations(static_cast<std::size_t>(capture.frame_count));
  for (const ClipRange& clip : capture.clips) {
    const int reach = std::max(1, static_cast<int>(std::lround(window_seconds * clip.fps)));
    const int stride = std::max(1, (2 * reach + 1) / kMaxSamples);
    for (int n = clip.first; n < clip.first + clip.count; ++n) {
      const int first = std::max(clip.first, n - reach);
      const int last = std::min(clip.first + clip.count - 1, n + reach);
      std::vector<Eigen::Matrix3d> now =
          SynchroniseRotations(MeanPairs(relative, static_cast<std::size_t>(first), static_cast<std::size_t>(last),
                                         static_cast<std::size_t>(stride), capture.view_count()));
      // The reference camera may change from frame to frame, so turn the world to where it moves least.
      if (n > clip.first) {
        const std::vector<Eigen::Matrix3d>& before = rotations[static_cast<std::size_t>(n - 1)];
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (std::size_t v = 0; v < now.size(); ++v) {
          if (now[v].allFinite() && before[v].allFinite()) sum += now[v].transpose() * before[v];
        }
        if (sum.squaredNorm() > 0.0) {
          const Eigen::Matrix3d now_from_before = NearestRotation(sum);
          for (Eigen::Matrix3d& rotation : now) rotation = (rotation * now_from_before).eval();
        }
      }
      rotations[static_cast<std::size_t>(n)] = std::move(now);
    }
  }
  return rotations;
}

}  // namespace canonpose
