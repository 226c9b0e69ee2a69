// The measures of 3D human pose estimation, as pure functions of a predicted and a true pose.
//
// clang-format off
//   N-MPJPE  mean distance of joints after both poses are centred on the root and the predicted pose is scaled by the
//            least-squares factor <P, G> / <P, P> (Rhodin et al. 2018)
//   PMPJPE   mean distance after the best similarity without reflection, so that a mirrored pose scores badly
//   PCK150   percentage of joints less than 150 mm off after the scale adjustment of N-MPJPE (a protocol may count only
//            some of the joints)
//   AUC      mean of PCK over the thresholds 0, 5, ..., 150 mm, as in the evaluation script of MPI-INF-3DHP
//   CPS      area under the curve of the fraction of poses whose largest joint error after similarity alignment is
//            below a threshold of 0 to 300 mm (Wandt et al. 2021); exactly, the mean of max(0, 300 - largest error)
// clang-format on
//
// The first four are means over all joints of all poses, the root included; CPS is a mean over poses.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace canonpose {

/// The joints that are used.
struct MetricJoints {
  int root = 0;
  std::vector<bool> included;  ///< (J) excluded joints are not used for scale and alignment either

  static MetricJoints All(int joint_count, int root) {
    return {root, std::vector<bool>(static_cast<std::size_t>(joint_count), true)};
  }
};

enum class PoseOutcome {
  kEvaluated,
  kTruthUnusable,      ///< the root, or more than half of the joints, or all but three, are unknown
  kPredictionMissing,  ///< the prediction is NaN at the root or at a joint whose truth is known
};

/// Distances of the joints of one pose; NaN for joints that are left out or unknown.
struct PoseErrors {
  PoseOutcome outcome = PoseOutcome::kTruthUnusable;
  double scale = 0.0;              ///< what the predicted pose was multiplied by for scaled_mm
  std::vector<double> scaled_mm;   ///< (J) after root-centring and scale adjustment
  std::vector<double> aligned_mm;  ///< (J) after similarity alignment
};

/// The number of known joints, of `included_count`, that a pose needs to be evaluated: half of them, but at least four
/// if there are as many, since three points are too easy to align.
int MinKnownJoints(int included_count);

/// `predicted` is (J, 3) in any unit, `truth` (J, 3) in mm, in the same frame; NaN where unknown.
PoseErrors ComparePoses(const float* predicted, const float* truth, const MetricJoints& joints);

/// Whether a predicted pose is mirrored. By the depth-reversal ambiguity, a single view can also be explained by the
/// mirror of the pose (z negated); this is true if the mirror has a smaller PMPJPE than the pose itself. Only for poses
/// whose outcome is kEvaluated.
bool IsMirrored(const float* predicted, const float* truth, const MetricJoints& joints);

/// The depth extent of poses, whether mirrored or not. A lifter that exaggerates depth to explain few views has a ratio
/// far above 1.
struct DepthSquares {
  double predicted = 0.0;  ///< mm^2, after scaling the predicted pose by its x and y alone
  double truth = 0.0;      ///< mm^2
};

/// Sums of squared depths relative to the root, over the joints that are used. Only for poses whose outcome is
/// kEvaluated.
DepthSquares CompareDepths(const float* predicted, const float* truth, const MetricJoints& joints);

/// The mean of each error over the known joints of a pose, and the largest aligned one. Only for poses whose outcome is
/// kEvaluated.
struct PoseMeans {
  double n_mpjpe_mm = 0.0;
  double p_mpjpe_mm = 0.0;
  double largest_aligned_mm = 0.0;
};
PoseMeans MeansOf(const PoseErrors& errors);

struct MeanErrors {
  double n_mpjpe_mm = 0.0;
  double p_mpjpe_mm = 0.0;
};

/// Curves have thresholds of 1, 2, ..., 300 mm.
inline constexpr int kCurveThresholds = 300;

/// Means over poses and joints; NaN if nothing was added.
struct Metrics {
  std::int64_t poses = 0;
  double n_mpjpe_mm = 0.0;
  double p_mpjpe_mm = 0.0;
  double pck_percent = 0.0;
  double auc_percent = 0.0;
  double cps = 0.0;
  /// (300) joints that are off by less than the threshold after the scale adjustment.
  std::vector<double> pck_curve_percent;
  /// (300) poses whose largest joint error after alignment is below the threshold.
  std::vector<double> cps_curve_percent;
  std::vector<MeanErrors> joints;  ///< (J) NaN for joints that are never known
};

/// The mean of several groups with equal weights; for a joint, of those groups that know it. `poses` is the sum.
Metrics AverageOf(const std::vector<Metrics>& groups);

/// The joints that PCK and AUC count, and the threshold at which they are wrong.
struct PckJoints {
  double threshold_mm = 150.0;
  std::vector<bool> counted;  ///< (J) empty: all that are used
};

/// Accumulates the errors of many poses without storing single ones.
class MetricSum {
 public:
  explicit MetricSum(PckJoints pck = {}) : pck_(std::move(pck)) {}
  /// Adds a pose whose outcome is kEvaluated. All must have the same number of joints.
  void Add(const PoseErrors& errors);
  [[nodiscard]] Metrics Mean() const;

 private:
  /// The errors of one joint, and how often it was known.
  struct JointSum {
    double scaled_mm = 0.0;
    double aligned_mm = 0.0;
    std::int64_t count = 0;
  };
  using Histogram = std::array<std::int64_t, kCurveThresholds>;

  PckJoints pck_;
  std::int64_t poses_ = 0;
  std::int64_t counted_joints_ = 0;  ///< for PCK and AUC
  double correct_ = 0.0;
  double area_ = 0.0;
  double cps_ = 0.0;
  std::vector<JointSum> joints_;
  Histogram first_correct_joints_{};  ///< how many joints become correct at the threshold of index + 1 mm
  Histogram first_correct_poses_{};
};

}  // namespace canonpose
