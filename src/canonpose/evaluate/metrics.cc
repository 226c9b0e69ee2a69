#include "canonpose/evaluate/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/base/error.h"
#include "canonpose/geometry/alignment.h"

namespace canonpose {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kAucStepMm = 5.0;
constexpr int kAucThresholds = 31;  // 0, 5, ..., 150
constexpr double kCpsLimitMm = 300.0;

bool IsKnown(const float* pose, std::size_t joint) {
  return std::isfinite(pose[3 * joint]) && std::isfinite(pose[3 * joint + 1]) && std::isfinite(pose[3 * joint + 2]);
}

Eigen::RowVector3d Point(const float* pose, std::size_t joint) {
  return {pose[3 * joint], pose[3 * joint + 1], pose[3 * joint + 2]};
}

/// Fraction of the thresholds 0, 5, ..., 150 that exceed the error.
double AreaOf(double error_mm) {
  int below = 0;
  for (int i = 0; i < kAucThresholds; ++i) below += error_mm < kAucStepMm * i ? 1 : 0;
  return static_cast<double>(below) / kAucThresholds;
}

/// Counts an error at the first of the thresholds 1, 2, ... that exceeds it.
void CountFrom(double error_mm, std::array<std::int64_t, kCurveThresholds>& histogram) {
  if (error_mm < kCurveThresholds) ++histogram[static_cast<std::size_t>(error_mm)];
}

std::vector<double> CurveOf(const std::array<std::int64_t, kCurveThresholds>& histogram, double count) {
  std::vector<double> curve;
  std::int64_t below = 0;
  for (const std::int64_t first : histogram) {
    below += first;
    curve.push_back(100.0 * static_cast<double>(below) / count);
  }
  return curve;
}

}  // namespace

int MinKnownJoints(int included_count) { return std::max((included_count + 1) / 2, std::min(4, included_count)); }

PoseErrors ComparePoses(const float* predicted, const float* truth, const MetricJoints& joints) {
  PoseErrors errors;
  const std::size_t joint_count = joints.included.size();
  const auto root = static_cast<std::size_t>(joints.root);
  std::vector<std::size_t> known;
  for (std::size_t j = 0; j < joint_count; ++j) {
    if (joints.included[j] && IsKnown(truth, j)) known.push_back(j);
  }
  const auto included = static_cast<int>(std::count(joints.included.begin(), joints.included.end(), true));
  if (!IsKnown(truth, root) || known.empty() || static_cast<int>(known.size()) < MinKnownJoints(included))
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
  errors.scale = LeastSquaresScale(P, G);
  const Eigen::VectorXd scaled = (errors.scale * P - G).rowwise().norm();
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

PoseMeans MeansOf(const PoseErrors& errors) {
  CANONPOSE_CHECK(errors.outcome == PoseOutcome::kEvaluated, "only evaluated poses have means");
  PoseMeans means;
  int count = 0;
  for (std::size_t j = 0; j < errors.scaled_mm.size(); ++j) {
    if (std::isnan(errors.scaled_mm[j])) continue;
    ++count;
    means.n_mpjpe_mm += errors.scaled_mm[j];
    means.p_mpjpe_mm += errors.aligned_mm[j];
    means.largest_aligned_mm = std::max(means.largest_aligned_mm, errors.aligned_mm[j]);
  }
  means.n_mpjpe_mm /= count;
  means.p_mpjpe_mm /= count;
  return means;
}

void MetricSum::Add(const PoseErrors& errors) {
  CANONPOSE_CHECK(errors.outcome == PoseOutcome::kEvaluated, "only evaluated poses can be added");
  joints_.resize(errors.scaled_mm.size());
  double largest_mm = 0.0;
  for (std::size_t j = 0; j < errors.scaled_mm.size(); ++j) {
    if (std::isnan(errors.scaled_mm[j])) continue;
    joints_[j].scaled_mm += errors.scaled_mm[j];
    joints_[j].aligned_mm += errors.aligned_mm[j];
    ++joints_[j].count;
    largest_mm = std::max(largest_mm, errors.aligned_mm[j]);
    if (!pck_.counted.empty() && !pck_.counted[j]) continue;
    ++counted_joints_;
    correct_ += errors.scaled_mm[j] < pck_.threshold_mm ? 1.0 : 0.0;
    area_ += AreaOf(errors.scaled_mm[j]);
    CountFrom(errors.scaled_mm[j], first_correct_joints_);
  }
  ++poses_;
  cps_ += std::max(0.0, kCpsLimitMm - largest_mm);
  CountFrom(largest_mm, first_correct_poses_);
}

Metrics MetricSum::Mean() const {
  JointSum all;
  Metrics mean;
  mean.poses = poses_;
  for (const JointSum& joint : joints_) {
    const double count = joint.count > 0 ? static_cast<double>(joint.count) : kNaN;
    mean.joints.push_back({joint.scaled_mm / count, joint.aligned_mm / count});
    all.scaled_mm += joint.scaled_mm;
    all.aligned_mm += joint.aligned_mm;
    all.count += joint.count;
  }
  const double joints = all.count > 0 ? static_cast<double>(all.count) : kNaN;
  const double counted = counted_joints_ > 0 ? static_cast<double>(counted_joints_) : kNaN;
  const double poses = poses_ > 0 ? static_cast<double>(poses_) : kNaN;
  mean.n_mpjpe_mm = all.scaled_mm / joints;
  mean.p_mpjpe_mm = all.aligned_mm / joints;
  mean.pck_percent = 100.0 * correct_ / counted;
  mean.auc_percent = 100.0 * area_ / counted;
  mean.cps = cps_ / poses;
  mean.pck_curve_percent = CurveOf(first_correct_joints_, counted);
  mean.cps_curve_percent = CurveOf(first_correct_poses_, poses);
  return mean;
}

Metrics AverageOf(const std::vector<Metrics>& groups) {
  CANONPOSE_CHECK(!groups.empty(), "nothing to average");
  const auto over = [&](const auto& value_of) {
    double sum = 0.0;
    int count = 0;
    for (const Metrics& group : groups) {
      const double value = value_of(group);
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
    }
    return count > 0 ? sum / count : kNaN;
  };
  Metrics mean;
  for (const Metrics& group : groups) mean.poses += group.poses;
  mean.n_mpjpe_mm = over([](const Metrics& group) { return group.n_mpjpe_mm; });
  mean.p_mpjpe_mm = over([](const Metrics& group) { return group.p_mpjpe_mm; });
  mean.pck_percent = over([](const Metrics& group) { return group.pck_percent; });
  mean.auc_percent = over([](const Metrics& group) { return group.auc_percent; });
  mean.cps = over([](const Metrics& group) { return group.cps; });
  for (std::size_t i = 0; i < static_cast<std::size_t>(kCurveThresholds); ++i) {
    mean.pck_curve_percent.push_back(over([i](const Metrics& group) { return group.pck_curve_percent[i]; }));
    mean.cps_curve_percent.push_back(over([i](const Metrics& group) { return group.cps_curve_percent[i]; }));
  }
  for (std::size_t j = 0; j < groups.front().joints.size(); ++j) {
    mean.joints.push_back({over([j](const Metrics& group) { return group.joints[j].n_mpjpe_mm; }),
                           over([j](const Metrics& group) { return group.joints[j].p_mpjpe_mm; })});
  }
  return mean;
}

}  // namespace canonpose
