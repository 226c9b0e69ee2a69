#include "canonpose/evaluate/report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const MeanErrors& errors) { return {{"n_mpjpe_mm", errors.n_mpjpe_mm}, {"p_mpjpe_mm", errors.p_mpjpe_mm}}; }

Json ToJson(const CanonicalDeviations& joint) {
  return {{"std_mm", joint.std_mm}, {"views_mm", joint.views_mm}, {"frames_mm", joint.frames_mm}};
}

Json ToJson(const CanonicalReport& canonical) {
  Json json;
  if (canonical.right_hip_std_mm) {
    json["hip_std_mm"] = {{"RHip", *canonical.right_hip_std_mm}, {"LHip", *canonical.left_hip_std_mm}};
  }
  json.update(ToJson(canonical.all));
  json["poses"] = canonical.poses;
  json["left_out"] = canonical.left_out;
  json["per_joint"] = Json::object();
  for (const auto& [name, joint] : canonical.per_joint) json["per_joint"][name] = ToJson(joint);
  return json;
}

void AddIfKnown(Json& json, const char* key, const std::optional<double>& value) {
  if (value) json[key] = *value;
}

void AddFigures(Json& json, const Metrics& metrics, const Protocol& protocol) {
  json["n_mpjpe_mm"] = metrics.n_mpjpe_mm;
  json["p_mpjpe_mm"] = metrics.p_mpjpe_mm;
  json[PckKey(protocol)] = metrics.pck_percent;
  json["auc_percent"] = metrics.auc_percent;
  json["cps"] = metrics.cps;
}

template <typename Groups>
Json GroupsToJson(const Groups& groups) {
  Json json = Json::object();
  for (const auto& [name, errors] : groups) json[name] = ToJson(errors);
  return json;
}

std::string Row(const std::string& name, const MeanErrors& errors) {
  return fmt::format("  {:<24}{:>10.1f}{:>10.1f}\n", name, errors.n_mpjpe_mm, errors.p_mpjpe_mm);
}

double MirroredPercent(const EvaluationReport& report) {
  return 100.0 * static_cast<double>(report.mirrored) / static_cast<double>(report.metrics.poses);
}

/// A wrong reference may look like mirrored poses.
std::string AdviceOnMirror(const EvaluationReport& report) {
  if (report.reference_is_doubtful) return "\n  Look at the calibration first: it does not fit the keypoints.";
  return report.mirror_advice.empty() ? "" : fmt::format("\n  Front and back are exchanged: {}.", report.mirror_advice);
}

std::string CameraPositions(const CameraErrors& cameras) {
  std::string text = fmt::format("\n  Mean angle error (AE) {:.2f} degrees, vertical field of view {:.2f} degrees",
                                 cameras.angle_deg, cameras.vertical_fov_deg);
  if (cameras.translation_mm) text += fmt::format(", position (TE) {:.0f} mm", *cameras.translation_mm);
  if (cameras.scaled_translation_mm)
    text += fmt::format(", scaled to fit (s-TE) {:.0f} mm", *cameras.scaled_translation_mm);
  return text;
}

std::string WorldLine(const WorldErrors& world) {
  std::string text = fmt::format(
      "\nWorld: joints are {:.1f} mm off where they are in the whole recording, after one similarity (WA-MPJPE)",
      world.wa_mpjpe_mm);
  if (world.w_mpjpe_mm)
    text += fmt::format(", {:.1f} mm with cameras aligned, not scaled (W-MPJPE)", *world.w_mpjpe_mm);
  return text;
}

/// What was compared with what, and what a reader should know about it.
std::string Heading(const EvaluationReport& report) {
  std::string text = fmt::format("Protocol: {}\n", report.protocol);
  text += fmt::format("Reference: {}", report.reference.description);
  if (!report.truth_kind.empty()) text += fmt::format(" ({})", report.truth_kind);
  if (report.reference.reprojection_px) {
    text += fmt::format(
        "; its own reprojection error is {:.1f} px (median; mean {:.1f} px), which limits the accuracy of the figures",
        report.reference.reprojection_px->median_px, report.reference.reprojection_px->mean_px);
  }
  text += fmt::format("\nPoses: {}", report.metrics.poses);
  if (report.missing_predictions > 0) text += fmt::format("; {} more were not predicted", report.missing_predictions);
  if (report.unusable_truths > 0) text += fmt::format("; {} more have too little truth", report.unusable_truths);
  if (report.left_out_sequences > 0) {
    text += fmt::format("; {} sequences of subjects other than {} were left out", report.left_out_sequences,
                        fmt::join(report.rules.subjects, " and "));
  }
  text += fmt::format("\nMirrored in depth: {:.1f} % of the poses", MirroredPercent(report));
  if (2 * report.mirrored > report.metrics.poses) text += AdviceOnMirror(report);
  text += fmt::format("\nDepth of the poses: {:.2f} times the truth's", report.depth_extent_ratio);
  if (report.cameras) {
    text += fmt::format(
        "\nCameras: relative rotations are {:.2f} degrees off ({:.2f} relative to the solved optical axes), focal "
        "lengths {:.1f} % (medians)",
        report.cameras->relative_rotation_deg, report.cameras->centred_rotation_deg, report.cameras->focal_percent);
    text += CameraPositions(*report.cameras);
  }
  if (report.world) text += WorldLine(*report.world);
  for (const std::string& warning : report.warnings) text += fmt::format("\nWarning: {}", warning);
  return text + "\n";
}

std::string FiguresRow(const std::string& name, const Metrics& figures) {
  return fmt::format("  {:<24}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}\n", name, figures.n_mpjpe_mm,
                     figures.p_mpjpe_mm, figures.pck_percent, figures.auc_percent, figures.cps);
}

template <typename Groups>
std::string Rows(const std::string& title, const Groups& groups) {
  std::string text = fmt::format("\n  by {}\n", title);
  for (const auto& [name, errors] : groups) text += Row(name, errors);
  return text;
}

std::string CanonicalTable(const CanonicalReport& canonical) {
  std::string text = fmt::format(
      "\n  canonical poses, deviations in mm{}\n  {:<24}{:>10}{:>10}{:>10}\n",
      canonical.left_out > 0 ? fmt::format(" (except {} that point away from their truth)", canonical.left_out) : "",
      "", "all", "views", "frames");
  const auto row = [](const std::string& name, const CanonicalDeviations& joint) {
    const std::string views = std::isnan(joint.views_mm) ? "one view" : fmt::format("{:.1f}", joint.views_mm);
    return fmt::format("  {:<24}{:>10.1f}{:>10}{:>10.1f}\n", name, joint.std_mm, views, joint.frames_mm);
  };
  text += row("mean over joints", canonical.all);
  for (const auto& [name, joint] : canonical.per_joint) text += row(name, joint);
  if (canonical.right_hip_std_mm) {
    return text + fmt::format("  hips: right {:.1f} mm, left {:.1f} mm (standard deviation over all poses)\n",
                              *canonical.right_hip_std_mm, *canonical.left_hip_std_mm);
  }
  return text + "  hips: the skeleton has none\n";
}

}  // namespace

std::string ReportAsJson(const EvaluationReport& report) {
  Json json;
  json["protocol"] = report.protocol;
  json["protocol_name"] = report.rules.name;
  json["headline"] = HeadlineKey(report.rules);
  json["frames"] = report.metrics.poses;
  json["joints"] = report.joints.size();
  AddFigures(json, report.metrics, report.rules);
  if (report.by_pose) AddFigures(json["by_pose"], *report.by_pose, report.rules);
  json["reference"] = report.reference.description;
  if (report.reference.reprojection_px) {
    json["reference_reprojection_error_px"] = {{"median", report.reference.reprojection_px->median_px},
                                               {"mean", report.reference.reprojection_px->mean_px}};
  }
  if (!report.truth_kind.empty()) json["truth_kind"] = report.truth_kind;
  json["warnings"] = report.warnings;
  json["left_out_sequences"] = report.left_out_sequences;
  json["missing_predictions"] = report.missing_predictions;
  json["unusable_truths"] = report.unusable_truths;
  json["mirrored_percent"] = MirroredPercent(report);
  json["depth_extent_ratio"] = report.depth_extent_ratio;
  json["left_out_joints"] = report.left_out_joints;
  if (report.cameras) {
    json["cameras"] = {{"relative_rotation_deg", report.cameras->relative_rotation_deg},
                       {"centred_rotation_deg", report.cameras->centred_rotation_deg},
                       {"focal_percent", report.cameras->focal_percent},
                       {"ae_deg", report.cameras->angle_deg},
                       {"vfov_error_deg", report.cameras->vertical_fov_deg}};
    AddIfKnown(json["cameras"], "te_mm", report.cameras->translation_mm);
    AddIfKnown(json["cameras"], "s_te_mm", report.cameras->scaled_translation_mm);
  }
  if (report.world) {
    json["world"] = {{"wa_mpjpe_mm", report.world->wa_mpjpe_mm}};
    AddIfKnown(json["world"], "w_mpjpe_mm", report.world->w_mpjpe_mm);
    json["world"]["pa_mpjpe_mm"] = report.world->pa_mpjpe_mm;
  }
  if (report.canonical) json["canonical"] = ToJson(*report.canonical);
  json["per_sequence"] = GroupsToJson(report.per_sequence);
  if (!report.per_action.empty()) json["per_action"] = GroupsToJson(report.per_action);
  json["per_joint"] = GroupsToJson(report.per_joint);
  json["cps_curve"] = report.metrics.cps_curve_percent;
  json["pck_curve"] = report.metrics.pck_curve_percent;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ReportAsTable(const EvaluationReport& report) {
  std::string text = Heading(report);
  text += fmt::format("\n  {:<24}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "N-MPJPE", "PMPJPE",
                      fmt::format("PCK{:.0f}", report.rules.pck.threshold_mm), "AUC", "CPS");
  text += fmt::format("  {:<24}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "mm", "mm", "%", "%", "0-300");
  text += FiguresRow("all", report.metrics);
  if (report.by_pose) text += FiguresRow("(mean over poses)", *report.by_pose);
  text += Rows("sequence", report.per_sequence);
  if (!report.per_action.empty()) text += Rows("action", report.per_action);
  text += Rows("joint", report.per_joint);
  if (report.canonical) text += CanonicalTable(*report.canonical);
  return text;
}

}  // namespace canonpose
