// Evaluating many poses by a protocol, and telling the result: as JSON for programs, as a table for people.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/evaluate/cameras.h"
#include "canonpose/evaluate/metrics.h"

namespace canonpose {

/// How far the pixels lie from where a triangulated reference projects, over all joints, frames and views. Errors of
/// the size that this has at the person's distance cannot be told apart with the reference.
struct ReferenceError {
  double median_px = 0.0;
  double mean_px = 0.0;
};

/// What the poses were compared with.
struct ReferenceKind {
  std::string description;                        ///< "truth", "triangulated from the calibration"
  std::optional<ReferenceError> reprojection_px;  ///< of a triangulated one
};

struct MeanErrors {
  double n_mpjpe_mm = 0.0;
  double p_mpjpe_mm = 0.0;
};

struct EvaluationReport {
  std::string protocol;  ///< in words
  ReferenceKind reference;
  Metrics metrics;                           ///< over all poses
  std::vector<std::string> joints;           ///< those that took part
  std::vector<std::string> left_out_joints;  ///< those the user left out
  std::int64_t missing_predictions = 0;      ///< poses whose truth is known but that were not predicted; in no mean
  std::int64_t unusable_truths = 0;          ///< poses left out because too little of their truth is known
  std::int64_t mirrored = 0;                 ///< poses whose depth mirror has the right shape rather than they
  double depth_extent_ratio = 0.0;           ///< root mean square depth of the poses, over that of the truth
  std::map<std::string, MeanErrors> per_sequence;
  std::vector<std::pair<std::string, MeanErrors>> per_joint;  ///< in the skeleton's order
  std::optional<CameraErrors> cameras;                        ///< where solved cameras and a calibration are known
};

/// The contract's keys, and beside them `reference`, `reference_reprojection_error_px` {median, mean} where the
/// reference was triangulated, `missing_predictions`, `unusable_truths`, `mirrored_percent`,
/// `depth_extent_ratio`, `left_out_joints` and, of solved cameras, `cameras` {relative_rotation_deg,
/// centred_rotation_deg, focal_percent}.
/// `frames` and `joints` are numbers.
std::string ReportAsJson(const EvaluationReport& report);

/// For the terminal; states the protocol in words, and a triangulated reference's own error.
std::string ReportAsTable(const EvaluationReport& report);

/// The only protocol so far; see ProtocolText().
inline constexpr const char* kAllFrames = "all-frames";

/// Takes poses one by one and sums them up.
class Evaluation {
 public:
  /// `left_out` are names of joints, in whatever case. Throws Error(kUsage) where one is unknown or none would be left.
  Evaluation(std::vector<std::string> joint_names, int root, const std::vector<std::string>& left_out);

  /// Both (J, 3); see ComparePoses().
  void Add(const std::string& sequence, const float* predicted, const float* truth);
  /// T poses of one view.
  void AddAll(const std::string& sequence, const std::vector<float>& predicted, const std::vector<float>& truth);

  /// Throws Error(kBadInput) naming `file` where no pose could be evaluated.
  [[nodiscard]] EvaluationReport Finish(const ReferenceKind& reference, const std::string& file) const;

 private:
  [[nodiscard]] std::string ProtocolText() const;

  std::vector<std::string> names_;
  MetricJoints joints_;
  MetricSum all_;
  std::map<std::string, MetricSum> sequences_;
  /// Sums of both errors and their number, of each joint.
  struct JointSum {
    double scaled_mm = 0.0;
    double aligned_mm = 0.0;
    std::int64_t count = 0;
  };
  std::vector<JointSum> joint_sums_;
  std::int64_t missing_predictions_ = 0;
  std::int64_t unusable_truths_ = 0;
  std::int64_t mirrored_ = 0;
  DepthSquares depths_;
};

}  // namespace canonpose
