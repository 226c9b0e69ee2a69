// Evaluates many poses by a protocol.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "canonpose/evaluate/frame_errors.h"
#include "canonpose/evaluate/metrics.h"
#include "canonpose/evaluate/protocol.h"
#include "canonpose/evaluate/report.h"

namespace canonpose {

/// Takes poses one by one and accumulates their errors.
class Evaluation {
 public:
  /// `left_out` are names of joints, ignoring case. Throws Error(kInvalidArgument) where one is unknown or no joint
  /// would remain.
  Evaluation(std::vector<std::string> joint_names, int root, const std::vector<std::string>& left_out,
             Protocol protocol = FindProtocol(kAllFrames));

  /// Also adds every further pose's errors to `frame_errors`, which must outlive this object.
  void KeepFrameErrors(FrameErrors* frame_errors) { frame_errors_ = frame_errors; }

  /// Adds a pose; both arrays are (J, 3), see ComparePoses(). Selecting the poses that the protocol evaluates is up to
  /// the caller (selection.h). Returns the errors that were added.
  PoseErrors Add(const PoseSource& source, const float* predicted, const float* truth);

  /// Throws Error(kBadInput) that names `file` if no pose could be evaluated.
  [[nodiscard]] EvaluationReport Finish(const ReferenceKind& reference, const std::string& file) const;

  [[nodiscard]] const std::vector<std::string>& joint_names() const { return names_; }
  [[nodiscard]] const MetricJoints& joints() const { return joints_; }

 private:
  void LeaveOut(const std::vector<std::string>& left_out);
  void FindPckJoints();
  /// The protocol's weighting; by poses, with a warning, if the protocol weights by actions and some pose has none.
  [[nodiscard]] Weighting PossibleWeighting(std::vector<std::string>* warnings) const;
  [[nodiscard]] Metrics Weighted(Weighting weighting) const;
  [[nodiscard]] std::string ProtocolText(Weighting weighting) const;

  Protocol protocol_;
  std::vector<std::string> names_;
  MetricJoints joints_;
  PckJoints pck_;
  std::vector<std::string> missing_pck_joints_;
  MetricSum all_;
  std::map<std::string, MetricSum> sequences_;
  std::map<std::string, MetricSum> actions_;  ///< "" has the poses without an action
  FrameErrors* frame_errors_ = nullptr;
  std::int64_t missing_predictions_ = 0;
  std::int64_t unusable_truths_ = 0;
  std::int64_t mirrored_ = 0;
  DepthSquares depths_;
};

}  // namespace canonpose
