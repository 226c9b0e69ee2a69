#include "canonpose/evaluate/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/base/error.h"
#include "canonpose/geometry/alignment.h"

namespace canonpose {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPckThresholdMm = 150.0;
constexpr double kAucStepMm = 5.0;
constexpr int kAucThresholds = 31;  // 0, 5, ..., 150
constexpr double kCpsLimitMm = 300.0;

bool IsKnown(const float* pose, std::size_t joint) {
  return std::isfinite(pose[3 * joint]) && std::isfinite(pose[3 * joint + 1]) && std::isfinite(pose[3 * joint + 2]);
}

Eigen::RowVector3d Point(const float* pose, std::size_t joint) {
  return {pose[3 * joint], pose[3 * joint + 1], pose[3 * joint + 2]};
}

/// Share of the thresholds 0, 5, ..., 150 that the error is below.
double AreaOf(double error_mm) {
  int below = 0;
  for (int i = 0; i < kAucThresholds; ++i) below += error_mm < kAucStepMm * i ? 1 : 0;
  return static_cast<double>(below) / kAucThresholds;
}

}  // namespace

int LeastKnownJoints(int included_count) { return std::max((included_count + 1) / 2, std::min(4, included_count)); }

PoseErrors ComparePoses(const float* predicted, const float* truth, const MetricJoints& joints) {
  PoseErrors errors;
  const std::size_t joint_count = joints.included.size();
  const auto root = static_cast<std::size_t>(joints.root);
  std::vector<std::size_t> known;
  for (std::size_t j = 0; j < joint_count; ++j) {
    if (joints.included[j] && IsKnown(truth, j)) known.push_back(j);
  }
  const auto included = static_cast<int>(std::count(joints.included.begin(), joints.included.end(), true));
  if (!IsKnown(truth, root) || known.empty() || static_cast<int>(known.size()) < LeastKnownJoints(included))
    return errors;

  errors.outcome = PoseOutcome::kPredictionMissing;
  const auto is_predicted = [&](std::size_t j) { return IsKnown(predicted, j); };
  if (!is_predicted(root) || !std::all_of(known.begin(), known.end(), is_predicted)) return errors;

  Points3d P(static_cast<Eigen::Index>(known.size()), 3);
  Points3d G(P.rows(), 3);
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    const std::size_t j = known[static_cast<std::size_t>(i)];
    P.row(i) = Point(predicted, j) - Point(predicted, root);
    G.row(i) = Point(truth, j) - Point(truth, root);
  }
  const Eigen::VectorXd scaled = (LeastSquaresScale(P, G) * P - G).rowwise().norm();
  const Eigen::VectorXd aligned = (AlignSimilarity(P, G).Apply(P) - G).rowwise().norm();
  errors.outcome = PoseOutcome::kEvaluated;
  errors.scaled_mm.assign(joint_count, kNaN);
  errors.aligned_mm.assign(joint_count, kNaN);
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    errors.scaled_mm[known[static_cast<std::size_t>(i)]] = scaled[i];
    errors.aligned_mm[known[static_cast<std::size_t>(i)]] = aligned[i];
  }
  return errors;
}

bool IsMirrored(const float* predicted, const float* truth, const MetricJoints& joints) {
  std::vector<float> mirrored(predicted, predicted + 3 * joints.included.size());
  for (std::size_t z = 2; z < mirrored.size(); z += 3) mirrored[z] = -mirrored[z];
  const auto sum_of_aligned = [&](const float* pose) {
    double sum = 0.0;
    for (const double distance_mm : ComparePoses(pose, truth, joints).aligned_mm) {
      if (!std::isnan(distance_mm)) sum += distance_mm;
    }
    return sum;
  };
  return sum_of_aligned(mirrored.data()) < sum_of_aligned(predicted);
}

DepthSquares CompareDepths(const float* predicted, const float* truth, const MetricJoints& joints) {
  const auto root = static_cast<std::size_t>(joints.root);
  double cross = 0.0;
  double plane = 0.0;
  DepthSquares depths;
  for (std::size_t j = 0; j < joints.included.size(); ++j) {
    if (!joints.included[j] || !IsKnown(truth, j)) continue;
    const Eigen::RowVector3d p = Point(predicted, j) - Point(predicted, root);
    const Eigen::RowVector3d g = Point(truth, j) - Point(truth, root);
    cross += p.head<2>().dot(g.head<2>());
    plane += p.head<2>().squaredNorm();
    depths.predicted += p.z() * p.z();
    depths.truth += g.z() * g.z();
  }
  const double scale = plane > 0.0 ? cross / plane : 0.0;
  depths.predicted *= scale * scale;
  return depths;
}

void MetricSum::Add(const PoseErrors& errors) {
  CANONPOSE_CHECK(errors.outcome == PoseOutcome::kEvaluated, "only evaluated poses are summed up");
  double largest_mm = 0.0;
  for (std::size_t j = 0; j < errors.scaled_mm.size(); ++j) {
    if (std::isnan(errors.scaled_mm[j])) continue;
    ++joints_;
    scaled_mm_ += errors.scaled_mm[j];
    aligned_mm_ += errors.aligned_mm[j];
    correct150_ += errors.scaled_mm[j] < kPckThresholdMm ? 1.0 : 0.0;
    area_ += AreaOf(errors.scaled_mm[j]);
    largest_mm = std::max(largest_mm, errors.aligned_mm[j]);
  }
  ++poses_;
  cps_ += std::max(0.0, kCpsLimitMm - largest_mm);
}

Metrics MetricSum::Mean() const {
  const double joints = joints_ > 0 ? static_cast<double>(joints_) : kNaN;
  const double poses = poses_ > 0 ? static_cast<double>(poses_) : kNaN;
  return {poses_,      scaled_mm_ / joints, aligned_mm_ / joints, 100.0 * correct150_ / joints, 100.0 * area_ / joints,
          cps_ / poses};
}

}  // namespace canonpose
