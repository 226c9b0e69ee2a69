// Telling the result of an evaluation: as JSON for programs, as a table for people.
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

struct EvaluationReport {
  std::string protocol;  ///< in words
  Protocol rules;
  ReferenceKind reference;
  std::string truth_kind;                    ///< as the data call it ("annot3"); empty where they do not
  std::vector<std::string> warnings;         ///< what is not as the protocol asks for, a sentence each
  std::int64_t left_out_sequences = 0;       ///< those of subjects that the protocol does not evaluate
  Metrics metrics;                           ///< weighted as the protocol says
  std::optional<Metrics> by_pose;            ///< over all poses, where that is another mean
  std::vector<std::string> all_joints;       ///< (J)
  std::vector<std::string> joints;           ///< those that took part
  std::vector<std::string> left_out_joints;  ///< those the user left out
  std::int64_t missing_predictions = 0;      ///< poses whose truth is known but that were not predicted; in no mean
  std::int64_t unusable_truths = 0;          ///< poses left out because too little of their truth is known
  std::int64_t mirrored = 0;                 ///< poses whose depth mirror has the right shape rather than they
  double depth_extent_ratio = 0.0;           ///< root mean square depth of the poses, over that of the truth
  std::map<std::string, MeanErrors> per_sequence;
  std::map<std::string, MeanErrors> per_action;               ///< empty where no actions are known
  std::vector<std::pair<std::string, MeanErrors>> per_joint;  ///< in the skeleton's order
  std::optional<CameraErrors> cameras;                        ///< where solved cameras and a calibration are known
  std::optional<CanonicalReport> canonical;                   ///< where it was asked for
};

/// The contract's keys, and beside them `protocol_name`, `headline` (the key of the figure to look at), `reference`,
/// `reference_reprojection_error_px` {median, mean} where the reference was triangulated, `truth_kind` where known,
/// `warnings`, `left_out_sequences`, `missing_predictions`, `unusable_truths`, `mirrored_percent`,
/// `depth_extent_ratio`, `left_out_joints`, of solved cameras `cameras` {relative_rotation_deg, centred_rotation_deg,
/// focal_percent}, `by_pose` (the five figures over all poses where the protocol weights otherwise), `per_action` where
/// actions are known, `cps_curve` and `pck_curve` (300 shares in %, for thresholds of 1, 2, ..., 300 mm) and, where
/// asked for, `canonical` {hip_std_mm {RHip, LHip}, std_mm, views_mm, frames_mm, per_joint, poses, left_out}. `frames`
/// and `joints` are numbers.
std::string ReportAsJson(const EvaluationReport& report);

/// For the terminal; states the protocol in words, and a triangulated reference's own error.
std::string ReportAsTable(const EvaluationReport& report);

}  // namespace canonpose
