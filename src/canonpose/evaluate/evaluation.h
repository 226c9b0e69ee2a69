// Evaluating many poses by a protocol.
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

/// Takes poses one by one and sums them up.
class Evaluation {
 public:
  /// `left_out` are names of joints, in whatever case. Throws Error(kInvalidArgument) where one is unknown or none
  /// would be left.
  Evaluation(std::vector<std::string> joint_names, int root, const std::vector<std::string>& left_out,
             Protocol protocol = FindProtocol(kAllFrames));

  /// From now on every pose's errors are added to `frame_errors` too, which must outlive this object.
  void KeepFrameErrors(FrameErrors* frame_errors) { frame_errors_ = frame_errors; }

  /// Both (J, 3); see ComparePoses(). Which poses the protocol wants is the caller's matter (selection.h). Returns what
  /// they have been summed up as.
  PoseErrors Add(const PoseSource& source, const float* predicted, const float* truth);

  /// Throws Error(kBadInput) naming `file` where no pose could be evaluated.
  [[nodiscard]] EvaluationReport Finish(const ReferenceKind& reference, const std::string& file) const;

  [[nodiscard]] const std::vector<std::string>& joint_names() const { return names_; }
  [[nodiscard]] const MetricJoints& joints() const { return joints_; }

 private:
  void LeaveOut(const std::vector<std::string>& left_out);
  void FindPckJoints();
  /// By poses where the protocol weights by actions and some pose has none; then it warns.
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
  std::map<std::string, MetricSum> actions_;  ///< "" holds the poses without one
  FrameErrors* frame_errors_ = nullptr;
  std::int64_t missing_predictions_ = 0;
  std::int64_t unusable_truths_ = 0;
  std::int64_t mirrored_ = 0;
  DepthSquares depths_;
};

}  // namespace canonpose
