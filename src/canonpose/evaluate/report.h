// Reports the result of an evaluation: as JSON for programs, as a table for people.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/evaluate/cameras.h"
#include "canonpose/evaluate/canonical.h"
#include "canonpose/evaluate/metrics.h"
#include "canonpose/evaluate/protocol.h"
#include "canonpose/evaluate/world.h"

namespace canonpose {

/// The distance between keypoints and the projection of a triangulated reference, over all joints, frames and views.
/// Differences in error that are smaller than this distance, at the person's depth, are not meaningful.
struct ReferenceError {
  double median_px = 0.0;
  double mean_px = 0.0;
};

/// The kind of poses used for comparison.
struct ReferenceKind {
  std::string description;                        ///< "truth", "triangulated from the calibration"
  std::optional<ReferenceError> reprojection_px;  ///< of a triangulated one
};

struct EvaluationReport {
  std::string protocol;  ///< in words
  Protocol rules;
  ReferenceKind reference;
  bool reference_is_doubtful = false;        ///< the calibration that it was triangulated from does not fit
  std::string mirror_advice;                 ///< what to do if most poses are mirrored; empty if nothing can be said
  std::string truth_kind;                    ///< the data's name for it ("annot3"); empty if there is none
  std::vector<std::string> warnings;         ///< what differs from the protocol, one sentence each
  std::int64_t left_out_sequences = 0;       ///< sequences of subjects that the protocol does not evaluate
  Metrics metrics;                           ///< weighted according to the protocol
  std::optional<Metrics> by_pose;            ///< means over all poses, if the protocol uses other means
  std::vector<std::string> all_joints;       ///< (J)
  std::vector<std::string> joints;           ///< joints that were used
  std::vector<std::string> left_out_joints;  ///< joints that the user left out
  /// Poses whose truth is known but that were not predicted; not part of any mean.
  std::int64_t missing_predictions = 0;
  std::int64_t unusable_truths = 0;  ///< poses that were left out because too little of their truth is known
  std::int64_t mirrored = 0;         ///< poses whose mirror has the right shape; see IsMirrored()
  double depth_extent_ratio = 0.0;   ///< root mean square depth of the poses, over that of the truth
  std::map<std::string, MeanErrors> per_sequence;
  std::map<std::string, MeanErrors> per_action;               ///< empty where no actions are known
  std::vector<std::pair<std::string, MeanErrors>> per_joint;  ///< in the skeleton's order
  std::optional<CameraErrors> cameras;                        ///< if there are both solved cameras and a calibration
  std::optional<WorldErrors> world;                           ///< of solved poses, if cameras are static
  std::optional<CanonicalReport> canonical;                   ///< if requested
};

/// The main figures (n_mpjpe_mm, p_mpjpe_mm, pck150_percent, auc_percent, cps), and also `protocol`, `protocol_name`,
/// `headline` (the key of the main figure), `reference`, `reference_reprojection_error_px` {median, mean} if the
/// reference was triangulated, `truth_kind` if known, `warnings`, `left_out_sequences`, `missing_predictions`,
/// `unusable_truths`, `mirrored_percent`, `depth_extent_ratio`, `left_out_joints`, for solved cameras `cameras`
/// {relative_rotation_deg, centred_rotation_deg, focal_percent, ae_deg, vfov_error_deg, te_mm, s_te_mm}, for solved
/// poses `world` {wa_mpjpe_mm, w_mpjpe_mm, pa_mpjpe_mm}, all as docs/evaluation.md defines them, `by_pose` (the five
/// figures over all poses if the protocol has another weighting), `per_action` if actions are known, `cps_curve` and
/// `pck_curve` (300 percentages, for thresholds of 1, 2, ..., 300 mm) and, if requested, `canonical` {hip_std_mm {RHip,
/// LHip}, std_mm, views_mm, frames_mm, per_joint, poses, left_out}. `frames` and `joints` are numbers.
std::string ReportAsJson(const EvaluationReport& report);

/// A table for the terminal, which also states the protocol in words and the error of a triangulated reference itself.
std::string ReportAsTable(const EvaluationReport& report);

}  // namespace canonpose
