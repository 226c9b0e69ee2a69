#include "canonpose/evaluate/report.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

bool SameName(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

Json ToJson(const MeanErrors& errors) { return {{"n_mpjpe_mm", errors.n_mpjpe_mm}, {"p_mpjpe_mm", errors.p_mpjpe_mm}}; }

std::string Row(const std::string& name, const MeanErrors& errors) {
  return fmt::format("  {:<24}{:>10.1f}{:>10.1f}\n", name, errors.n_mpjpe_mm, errors.p_mpjpe_mm);
}

double MirroredPercent(const EvaluationReport& report) {
  return 100.0 * static_cast<double>(report.mirrored) / static_cast<double>(report.metrics.poses);
}

}  // namespace

std::string ReportAsJson(const EvaluationReport& report) {
  Json json;
  json["protocol"] = report.protocol;
  json["frames"] = report.metrics.poses;
  json["joints"] = report.joints.size();
  json["n_mpjpe_mm"] = report.metrics.n_mpjpe_mm;
  json["p_mpjpe_mm"] = report.metrics.p_mpjpe_mm;
  json["pck150_percent"] = report.metrics.pck150_percent;
  json["auc_percent"] = report.metrics.auc_percent;
  json["cps"] = report.metrics.cps;
  json["reference"] = report.reference.description;
  if (report.reference.reprojection_px) {
    json["reference_reprojection_error_px"] = {{"median", report.reference.reprojection_px->median_px},
                                               {"mean", report.reference.reprojection_px->mean_px}};
  }
  json["missing_predictions"] = report.missing_predictions;
  json["unusable_truths"] = report.unusable_truths;
  json["mirrored_percent"] = MirroredPercent(report);
  json["depth_extent_ratio"] = report.depth_extent_ratio;
  json["left_out_joints"] = report.left_out_joints;
  if (report.cameras) {
    json["cameras"] = {{"relative_rotation_deg", report.cameras->relative_rotation_deg},
                       {"centred_rotation_deg", report.cameras->centred_rotation_deg},
                       {"focal_percent", report.cameras->focal_percent}};
  }
  json["per_sequence"] = Json::object();
  for (const auto& [name, errors] : report.per_sequence) json["per_sequence"][name] = ToJson(errors);
  json["per_joint"] = Json::object();
  for (const auto& [name, errors] : report.per_joint) json["per_joint"][name] = ToJson(errors);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ReportAsTable(const EvaluationReport& report) {
  std::string text = fmt::format("Protocol: {}\n", report.protocol);
  text += fmt::format("Reference: {}", report.reference.description);
  if (report.reference.reprojection_px) {
    text += fmt::format(
        "; its own reprojection error is {:.1f} px (median; mean {:.1f} px), so the figures hold only to that",
        report.reference.reprojection_px->median_px, report.reference.reprojection_px->mean_px);
  }
  text += fmt::format("\nPoses: {}", report.metrics.poses);
  if (report.missing_predictions > 0) text += fmt::format("; {} more were not predicted", report.missing_predictions);
  if (report.unusable_truths > 0) text += fmt::format("; {} more have too little truth", report.unusable_truths);
  text += fmt::format("\nMirrored in depth: {:.1f} % of the poses", MirroredPercent(report));
  if (2 * report.mirrored > report.metrics.poses)
    text += " (train again with --mirror flip, or keep where `info` says it was flipped)";
  text += fmt::format("\nDepth of the poses: {:.2f} times the truth's", report.depth_extent_ratio);
  if (report.cameras) {
    text += fmt::format(
        "\nCameras: relative rotations {:.2f} degrees off ({:.2f} about the axes that were solved for), focal "
        "lengths {:.1f} % (medians)",
        report.cameras->relative_rotation_deg, report.cameras->centred_rotation_deg, report.cameras->focal_percent);
  }
  text += fmt::format("\n\n  {:<24}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "N-MPJPE", "PMPJPE", "PCK150", "AUC", "CPS");
  text += fmt::format("  {:<24}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "mm", "mm", "%", "%", "0-300");
  const Metrics& all = report.metrics;
  text += fmt::format("  {:<24}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}\n", "all", all.n_mpjpe_mm, all.p_mpjpe_mm,
                      all.pck150_percent, all.auc_percent, all.cps);
  text += "\n  by sequence\n";
  for (const auto& [name, errors] : report.per_sequence) text += Row(name, errors);
  text += "\n  by joint\n";
  for (const auto& [name, errors] : report.per_joint) text += Row(name, errors);
  return text;
}

Evaluation::Evaluation(std::vector<std::string> joint_names, int root, const std::vector<std::string>& left_out)
    : names_(std::move(joint_names)), joints_(MetricJoints::All(static_cast<int>(names_.size()), root)) {
  CANONPOSE_CHECK(root >= 0 && root < static_cast<int>(names_.size()), "root {} of {} joints", root, names_.size());
  for (const std::string& name : left_out) {
    const auto found =
        std::find_if(names_.begin(), names_.end(), [&](const std::string& joint) { return SameName(joint, name); });
    if (found == names_.end()) {
      ThrowUsage("there is no joint '{}' to leave out; the joints are {}", name, fmt::join(names_, ", "));
    }
    joints_.included[static_cast<std::size_t>(found - names_.begin())] = false;
  }
  if (std::none_of(joints_.included.begin(), joints_.included.end(), [](bool included) { return included; })) {
    ThrowUsage("all joints are left out");
  }
  joint_sums_.resize(names_.size());
}

void Evaluation::Add(const std::string& sequence, const float* predicted, const float* truth) {
  const PoseErrors errors = ComparePoses(predicted, truth, joints_);
  if (errors.outcome == PoseOutcome::kTruthUnusable) ++unusable_truths_;
  if (errors.outcome == PoseOutcome::kPredictionMissing) ++missing_predictions_;
  if (errors.outcome != PoseOutcome::kEvaluated) return;
  if (IsMirrored(predicted, truth, joints_)) ++mirrored_;
  const DepthSquares depths = CompareDepths(predicted, truth, joints_);
  depths_.predicted += depths.predicted;
  depths_.truth += depths.truth;
  all_.Add(errors);
  sequences_[sequence].Add(errors);
  for (std::size_t j = 0; j < names_.size(); ++j) {
    if (std::isnan(errors.scaled_mm[j])) continue;
    joint_sums_[j].scaled_mm += errors.scaled_mm[j];
    joint_sums_[j].aligned_mm += errors.aligned_mm[j];
    ++joint_sums_[j].count;
  }
}

void Evaluation::AddAll(const std::string& sequence, const std::vector<float>& predicted,
                        const std::vector<float>& truth) {
  const std::size_t row = 3 * names_.size();
  CANONPOSE_CHECK(predicted.size() == truth.size() && truth.size() % row == 0, "{} and {} values, {} a pose",
                  predicted.size(), truth.size(), row);
  for (std::size_t i = 0; i < truth.size(); i += row) Add(sequence, &predicted[i], &truth[i]);
}

std::string Evaluation::ProtocolText() const {
  const auto included = static_cast<int>(std::count(joints_.included.begin(), joints_.included.end(), true));
  std::string text = fmt::format(
      "{}: every frame of every view by itself whose truth has the root ({}) and at least {} of {} joints; N-MPJPE, "
      "PCK and "
      "AUC after centring on the root and one scale factor a pose, PMPJPE and CPS after similarity alignment without "
      "reflection; means over all joints, the root included",
      kAllFrames, names_[static_cast<std::size_t>(joints_.root)], LeastKnownJoints(included), included);
  std::vector<std::string> left_out;
  for (std::size_t j = 0; j < names_.size(); ++j) {
    if (!joints_.included[j]) left_out.push_back(names_[j]);
  }
  if (!joints_.included[static_cast<std::size_t>(joints_.root)]) {
    text.replace(text.rfind(", the root included"), std::string::npos, "");
  }
  if (!left_out.empty()) text += fmt::format("; without {}", fmt::join(left_out, ", "));
  return text;
}

EvaluationReport Evaluation::Finish(const ReferenceKind& reference, const std::string& file) const {
  EvaluationReport report;
  report.protocol = ProtocolText();
  report.reference = reference;
  report.metrics = all_.Mean();
  report.missing_predictions = missing_predictions_;
  report.unusable_truths = unusable_truths_;
  report.mirrored = mirrored_;
  report.depth_extent_ratio = std::sqrt(depths_.predicted / depths_.truth);
  if (report.metrics.poses == 0) {
    ThrowBadInput({file, "", "at least one pose that is known and predicted",
                   fmt::format("{} not predicted, {} with too little truth", missing_predictions_, unusable_truths_),
                   ""});
  }
  for (const auto& [name, sum] : sequences_) {
    const Metrics mean = sum.Mean();
    report.per_sequence[name] = {mean.n_mpjpe_mm, mean.p_mpjpe_mm};
  }
  for (std::size_t j = 0; j < names_.size(); ++j) {
    (joints_.included[j] ? report.joints : report.left_out_joints).push_back(names_[j]);
    const JointSum& sum = joint_sums_[j];
    if (sum.count == 0) continue;
    const auto count = static_cast<double>(sum.count);
    report.per_joint.emplace_back(names_[j], MeanErrors{sum.scaled_mm / count, sum.aligned_mm / count});
  }
  return report;
}

}  // namespace canonpose
