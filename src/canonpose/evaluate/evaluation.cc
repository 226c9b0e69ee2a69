#include "canonpose/evaluate/evaluation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/names.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

std::vector<Metrics> MeansOf(const std::map<std::string, MetricSum>& groups) {
  std::vector<Metrics> means;
  for (const auto& [name, sum] : groups) means.push_back(sum.Mean());
  return means;
}

std::map<std::string, MeanErrors> MeanErrorsOf(const std::map<std::string, MetricSum>& groups) {
  std::map<std::string, MeanErrors> errors;
  for (const auto& [name, sum] : groups) {
    if (name.empty()) continue;
    const Metrics mean = sum.Mean();
    errors[name] = {mean.n_mpjpe_mm, mean.p_mpjpe_mm};
  }
  return errors;
}

/// A joint whose error is so much larger than that of the others is probably another joint, or badly detected.
constexpr double kOutstandingFactor = 5.0;
constexpr double kSmallestOutstandingMm = 30.0;
constexpr std::size_t kFewestJointsToCompare = 6;

double MedianOver(const EvaluationReport& report, double MeanErrors::*error_mm) {
  std::vector<double> errors_mm;
  for (const auto& [name, errors] : report.per_joint) errors_mm.push_back(errors.*error_mm);
  return Median(std::move(errors_mm));
}

void WarnOfOutstandingJoints(EvaluationReport& report) {
  if (report.per_joint.size() < kFewestJointsToCompare) return;
  // Alignment spreads the error of one joint over the others, centring does not; but centring adds a tilt of the body.
  const double usual_n_mm = MedianOver(report, &MeanErrors::n_mpjpe_mm);
  const double usual_p_mm = MedianOver(report, &MeanErrors::p_mpjpe_mm);
  for (const auto& [name, errors] : report.per_joint) {
    const bool is_worse_aligned = errors.p_mpjpe_mm / usual_p_mm > errors.n_mpjpe_mm / usual_n_mm;
    const double error_mm = is_worse_aligned ? errors.p_mpjpe_mm : errors.n_mpjpe_mm;
    const double usual_mm = is_worse_aligned ? usual_p_mm : usual_n_mm;
    if (error_mm < std::max(kOutstandingFactor * usual_mm, kSmallestOutstandingMm)) continue;
    report.warnings.push_back(fmt::format(
        "{} is {:.0f} mm off, {:.0f} times as much as the joints' median of {:.0f} mm ({}): is it the same joint in "
        "both, and is it detected? `exclude_joints={}` leaves it out",
        name, error_mm, error_mm / usual_mm, usual_mm, is_worse_aligned ? "PMPJPE" : "N-MPJPE", name));
  }
}

}  // namespace

Evaluation::Evaluation(std::vector<std::string> joint_names, int root, const std::vector<std::string>& left_out,
                       Protocol protocol)
    : protocol_(std::move(protocol)),
      names_(std::move(joint_names)),
      joints_(MetricJoints::All(static_cast<int>(names_.size()), root)) {
  CANONPOSE_CHECK(root >= 0 && root < static_cast<int>(names_.size()), "root {} of {} joints", root, names_.size());
  LeaveOut(left_out);
  FindPckJoints();
  all_ = MetricSum(pck_);
}

void Evaluation::LeaveOut(const std::vector<std::string>& left_out) {
  for (const std::string& name : left_out) {
    const auto found =
        std::find_if(names_.begin(), names_.end(), [&](const std::string& joint) { return SameName(joint, name); });
    if (found == names_.end()) {
      ThrowInvalidArgument("there is no joint '{}' to leave out; the joints are {}", name, fmt::join(names_, ", "));
    }
    joints_.included[static_cast<std::size_t>(found - names_.begin())] = false;
  }
  if (std::none_of(joints_.included.begin(), joints_.included.end(), [](bool included) { return included; })) {
    ThrowInvalidArgument("all joints are left out");
  }
}

void Evaluation::FindPckJoints() {
  pck_.threshold_mm = protocol_.pck.threshold_mm;
  if (protocol_.pck.joints.empty()) return;
  const Skeleton skeleton{"", names_, {}, joints_.root, {}};
  pck_.counted.assign(names_.size(), false);
  for (const std::vector<std::string>& wanted : protocol_.pck.joints) {
    std::optional<int> joint;
    for (const std::string& name : wanted) {
      if (!joint) joint = skeleton.Find(name);
      if (!joint) joint = FindPart(skeleton, name);
    }
    if (joint && joints_.included[static_cast<std::size_t>(*joint)]) {
      pck_.counted[static_cast<std::size_t>(*joint)] = true;
    } else {
      missing_pck_joints_.push_back(wanted.front());
    }
  }
}

PoseErrors Evaluation::Add(const PoseSource& source, const float* predicted, const float* truth) {
  const PoseErrors errors = ComparePoses(predicted, truth, joints_);
  if (errors.outcome == PoseOutcome::kTruthUnusable) ++unusable_truths_;
  if (errors.outcome == PoseOutcome::kPredictionMissing) ++missing_predictions_;
  if (errors.outcome != PoseOutcome::kEvaluated) return errors;
  const bool mirrored = IsMirrored(predicted, truth, joints_);
  if (mirrored) ++mirrored_;
  const DepthSquares depths = CompareDepths(predicted, truth, joints_);
  depths_.predicted += depths.predicted;
  depths_.truth += depths.truth;
  all_.Add(errors);
  sequences_.try_emplace(source.sequence, pck_).first->second.Add(errors);
  actions_.try_emplace(ActionOf(protocol_, source.action), pck_).first->second.Add(errors);
  if (frame_errors_ != nullptr) frame_errors_->Add(source, errors, mirrored);
  return errors;
}

Weighting Evaluation::PossibleWeighting(std::vector<std::string>* warnings) const {
  if (protocol_.weighting != Weighting::kActions || actions_.count("") == 0) return protocol_.weighting;
  warnings->push_back(
      fmt::format("{} takes means over actions, but the data do not name {}; using means over poses instead",
                  protocol_.name, actions_.size() == 1 ? "any" : "those of all poses"));
  return Weighting::kPoses;
}

Metrics Evaluation::Weighted(Weighting weighting) const {
  switch (weighting) {
    case Weighting::kSequences:
      return AverageOf(MeansOf(sequences_));
    case Weighting::kActions:
      return AverageOf(MeansOf(actions_));
    case Weighting::kPoses:
      break;
  }
  return all_.Mean();
}

std::string Evaluation::ProtocolText(Weighting weighting) const {
  Protocol protocol = protocol_;
  protocol.weighting = weighting;
  const auto included = static_cast<int>(std::count(joints_.included.begin(), joints_.included.end(), true));
  const auto root = static_cast<std::size_t>(joints_.root);
  std::string text = fmt::format(
      "{}: {}, each by itself, where its truth has the root ({}) and at least {} of {} joints; N-MPJPE, PCK and AUC "
      "after "
      "centring on the root and one scale factor per pose, PMPJPE and CPS after similarity alignment without "
      "reflection",
      protocol.name, PosesInWords(protocol), names_[root], MinKnownJoints(included), included);
  text +=
      fmt::format("; {} and joints{}", WeightingInWords(protocol), joints_.included[root] ? ", the root included" : "");
  std::vector<std::string> counted;
  std::vector<std::string> left_out;
  for (std::size_t j = 0; j < names_.size(); ++j) {
    if (!pck_.counted.empty() && pck_.counted[j]) counted.push_back(names_[j]);
    if (!joints_.included[j]) left_out.push_back(names_[j]);
  }
  if (!pck_.counted.empty()) {
    text += fmt::format("; PCK and AUC over {} joints ({})", counted.size(), fmt::join(counted, ", "));
  }
  if (protocol.name != kAllFrames) text += fmt::format("; its headline is {}", HeadlineName(protocol));
  if (!left_out.empty()) text += fmt::format("; without {}", fmt::join(left_out, ", "));
  return text;
}

EvaluationReport Evaluation::Finish(const ReferenceKind& reference, const std::string& file) const {
  if (all_.Mean().poses == 0) {
    ThrowBadInput({file, "", "at least one pose that is both known and predicted",
                   fmt::format("{} not predicted, {} with too little truth", missing_predictions_, unusable_truths_),
                   ""});
  }
  EvaluationReport report;
  const Weighting weighting = PossibleWeighting(&report.warnings);
  if (!missing_pck_joints_.empty()) {
    report.warnings.push_back(fmt::format("{} counts joints for PCK and AUC that are missing or left out: {}",
                                          protocol_.name, fmt::join(missing_pck_joints_, ", ")));
  }
  report.rules = protocol_;
  report.all_joints = names_;
  report.protocol = ProtocolText(weighting);
  report.reference = reference;
  report.metrics = Weighted(weighting);
  if (weighting != Weighting::kPoses) report.by_pose = all_.Mean();
  report.missing_predictions = missing_predictions_;
  report.unusable_truths = unusable_truths_;
  report.mirrored = mirrored_;
  report.depth_extent_ratio = std::sqrt(depths_.predicted / depths_.truth);
  report.per_sequence = MeanErrorsOf(sequences_);
  report.per_action = MeanErrorsOf(actions_);
  for (std::size_t j = 0; j < names_.size(); ++j) {
    (joints_.included[j] ? report.joints : report.left_out_joints).push_back(names_[j]);
    const MeanErrors& errors = report.metrics.joints[j];
    if (!std::isnan(errors.n_mpjpe_mm)) report.per_joint.emplace_back(names_[j], errors);
  }
  WarnOfOutstandingJoints(report);
  return report;
}

}  // namespace canonpose
