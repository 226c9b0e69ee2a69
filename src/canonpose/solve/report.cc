#include "canonpose/solve/report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/median.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kOutlierScatters = 5.0;
/// A lens that moves the image's corner by less is not worth a line.
constexpr double kNegligiblePx = 1.0;
/// Good captures have up to 11 %.
constexpr double kManyOutliersPercent = 12.0;
/// Two of four moving cameras at half the frame rate have 21 to 29 %, static ones 13 % and more; of the latter, those
/// with few outliers have bones of changing lengths.
constexpr double kContradictingOutliersPercent = 18.0;

std::string DescribeMirror(const Solution& solution, const std::string& option) {
  if (option == "keep") return "kept by request";
  if (option == "flip") return "flipped by request";
  if (solution.mirrored) return "flipped";
  return solution.mirror_sigma > kDecisiveSigma ? "kept" : "undecided, kept as in the start's poses";
}

CameraReport DescribeCamera(const CaptureObservations& capture, const Solution& solution, int v,
                            std::vector<double> errors, std::int64_t outliers) {
  const ObservedCamera& observed = capture.cameras[static_cast<std::size_t>(v)];
  CameraReport report;
  report.name = observed.name;
  std::vector<double> focal_px;
  for (int n = 0; n < (capture.static_cameras ? 1 : capture.frame_count); ++n) {
    const CameraEstimate& camera = solution.estimate.CameraAt(n, v);
    if (camera.valid) focal_px.push_back(camera.Focal() * observed.diagonal_px);
  }
  report.used = !focal_px.empty();
  report.focal_px = Median(std::move(focal_px));
  report.corner_shift_px = 0.5 * observed.diagonal_px * observed.lens.CornerShift();
  report.outlier_percent =
      errors.empty() ? 0.0 : 100.0 * static_cast<double>(outliers) / static_cast<double>(errors.size());
  report.reprojection_percent = 100.0 * Median(std::move(errors));
  return report;
}

/// The frames of windows that failed, by number (F).
std::vector<bool> InFailedWindow(const CaptureObservations& capture, const WindowsSummary& windows) {
  std::vector<bool> failed(static_cast<std::size_t>(capture.frame_count), false);
  for (const FailedWindow& window : windows.failed) {
    const int first = capture.clips[static_cast<std::size_t>(window.clip)].first + window.first_frame;
    std::fill_n(failed.begin() + first, window.frame_count, true);
  }
  return failed;
}

/// Counts the frames that are solved and, by reason, those that are not.
void CountFrames(const CaptureObservations& capture, const RigEstimate& estimate, const WindowsSummary& windows,
                 CaptureReport& report) {
  const std::vector<bool> in_failed_window = InFailedWindow(capture, windows);
  for (int n = 0; n < capture.frame_count; ++n) {
    const bool has_failed = in_failed_window[static_cast<std::size_t>(n)];
    int seen = 0;
    bool is_seen = false;
    for (int v = 0; v < capture.view_count(); ++v) {
      bool any = false;
      for (int j = 0; j < capture.joint_count(); ++j) any = any || capture.Sees(n, v, j);
      // The moving cameras of a window that failed are not valid any more.
      is_seen = is_seen || any;
      seen += any && (estimate.CameraAt(n, v).valid || has_failed) ? 1 : 0;
    }
    bool solved = false;
    for (int j = 0; j < capture.joint_count(); ++j) solved = solved || estimate.Joint(n, j).allFinite();
    if (solved) {
      ++report.frames_solved;
    } else if (seen < 2) {
      ++report.frames_too_few_views;
      report.frames_unseen += is_seen ? 0 : 1;
    } else if (has_failed) {
      ++report.frames_in_failed_windows;
    }
  }
}

/// One line; empty where no window failed.
std::string DescribeFailedWindows(const CaptureReport& report) {
  if (!report.windows || report.windows->failed.empty()) return "";
  return fmt::format("{} frames are not solved: the bundle adjustment of {} of {} windows failed ({})",
                     report.frames_in_failed_windows, report.windows->failed.size(), report.windows->windows,
                     report.windows->failed.front().reason);
}

/// NaN becomes null.
Json CostToJson(double cost) { return std::isfinite(cost) ? Json(cost) : Json(nullptr); }

Json AdjustmentToJson(const std::optional<AdjustmentSummary>& summary) {
  if (!summary) return nullptr;
  return {{"ending", NameOf(summary->ending)},
          {"reason", summary->reason},
          {"iterations", summary->iterations},
          {"initial_cost", CostToJson(summary->initial_cost)},
          {"final_cost", CostToJson(summary->final_cost)}};
}

Json WindowsToJson(const std::optional<WindowsSummary>& summary) {
  if (!summary) return nullptr;
  Json failures = Json::array();
  for (const FailedWindow& window : summary->failed) {
    failures.push_back({{"clip", window.clip},
                        {"first_frame", window.first_frame},
                        {"frames", window.frame_count},
                        {"reason", window.reason}});
  }
  return {{"count", summary->windows},
          {"converged", summary->converged},
          {"stopped_early", summary->stopped_early},
          {"failed", summary->failed.size()},
          {"iterations", summary->iterations},
          {"initial_cost", CostToJson(summary->initial_cost)},
          {"final_cost", CostToJson(summary->final_cost)},
          {"failures", failures}};
}

/// What is known of the world, a line each.
std::string DescribeWorld(const CaptureReport& report) {
  const bool is_metric = report.unit == LengthUnit::kMillimetres;
  const auto length = [&](double value) {
    return is_metric ? fmt::format("{:.0f} mm", value) : fmt::format("{:.2g} body lengths", value);
  };
  std::string text = "  up          ";
  text += report.world.up.is_known()
              ? fmt::format("within {:.1f} degrees, from {}\n", report.world.up.uncertainty, report.world.up.source)
              : "not known\n";
  text += "  floor       ";
  if (report.world.floor.is_known()) {
    text += fmt::format("within {}, from {}\n", length(report.world.floor.uncertainty), report.world.floor.source);
  } else if (report.static_cameras) {
    text += "not known, because the feet are not\n";
  } else {
    text += "not known, nor where the person walks, because the cameras move: the person stays at one place\n";
  }
  text += "  scale       ";
  return text + (is_metric ? fmt::format("millimetres within {:.1f} %, from {}\n", report.world.scale.uncertainty,
                                         report.world.scale.source)
                           : std::string("not known: all bones of the body together have the length 1\n"));
}

Json WorldToJson(const CaptureReport& report) {
  const auto to_json = [](const Provenance& known, const char* uncertainty) -> Json {
    if (!known.is_known()) return nullptr;
    return {{"source", known.source}, {uncertainty, CostToJson(known.uncertainty)}};
  };
  return {{"unit", ToString(report.unit)},
          {"up", to_json(report.world.up, "uncertainty_degrees")},
          {"floor", to_json(report.world.floor, "uncertainty")},
          {"scale", to_json(report.world.scale, "uncertainty_percent")}};
}

std::string DescribePeople(const PeopleReport& report) {
  std::string text =
      fmt::format("{} ({} {})\n", report.scene, report.people.size(), report.people.size() == 1 ? "person" : "people");
  for (const PersonReport& person : report.people) {
    std::vector<std::string> cameras;
    for (const auto& [camera, frames] : person.frames_of_camera)
      cameras.push_back(fmt::format("{} {}", camera, frames));
    text += fmt::format("  {}: {} of {} frames in two cameras or more ({}); off by {:.2f} %, {:.0f} % sure\n",
                        person.name, person.frames, report.frames, fmt::join(cameras, ", "),
                        person.reprojection_percent, person.sure_percent);
  }
  text += fmt::format("  these are {:.0f} % of what the cameras show\n", report.explained_percent);
  for (const std::string& line : report.left_out) text += fmt::format("  {}\n", line);
  return text;
}

Json PeopleToJson(const PeopleReport& report) {
  Json people = Json::array();
  for (const PersonReport& person : report.people) {
    Json cameras = Json::object();
    for (const auto& [camera, frames] : person.frames_of_camera) cameras[camera] = frames;
    people.push_back({{"name", person.name},
                      {"frames", person.frames},
                      {"frames_of_camera", std::move(cameras)},
                      {"reprojection_percent", person.reprojection_percent},
                      {"sure_percent", person.sure_percent}});
  }
  return {{"scene", report.scene},
          {"frames", report.frames},
          {"people", std::move(people)},
          {"left_out", report.left_out},
          {"explained_percent", report.explained_percent}};
}

/// One line: when a camera began, how fast its clock runs, and how sure that is.
std::string DescribeClock(const ViewClockEstimate& clock, std::size_t clips) {
  std::string text = fmt::format("  {:<11} ", clock.camera);
  if (clock.source == ClockSource::kUnknown) {
    text += fmt::format("not synchronised: it {}", clock.reason);
  } else if (clock.source == ClockSource::kAsRecorded) {
    text += "synchronised as recorded: its motion shows nothing else";
  } else if (clock.source == ClockSource::kReference) {
    text += "the others are synchronised with it";
  } else {
    text += fmt::format("began {:.3f} s {}", std::abs(clock.offset_seconds),
                        clock.offset_seconds < 0.0 ? "earlier" : "later");
    if (clock.source == ClockSource::kGiven) text += ", as given";
    if (clock.source == ClockSource::kMotion) text += fmt::format(" (within {:.1f} ms)", 1e3 * clock.deviation_seconds);
    const double rate = 1.0 / clock.time.rate;
    if (std::abs(rate - 1.0) > 5e-3) {
      text += fmt::format(", {:.5g} times the frame rate", rate);
    } else if (rate != 1.0) {
      text += fmt::format(", clock {:.0f} ppm {}", 1e6 * std::abs(rate - 1.0), rate > 1.0 ? "fast" : "slow");
    }
  }
  if (clips > 1) text += fmt::format(", in clip {}", clock.clip + 1);
  return text + "\n";
}

std::string DescribeClocks(const CaptureReport& capture) {
  int clips = 0;
  for (const ViewClockEstimate& clock : capture.clocks) clips = std::max(clips, clock.clip + 1);
  std::string text;
  for (const ViewClockEstimate& clock : capture.clocks) text += DescribeClock(clock, static_cast<std::size_t>(clips));
  return text;
}

Json ClocksToJson(const CaptureReport& capture) {
  Json clocks = Json::array();
  for (const ViewClockEstimate& clock : capture.clocks) {
    Json one = {{"clip", clock.clip}, {"camera", clock.camera}, {"source", NameOf(clock.source)}};
    if (clock.source == ClockSource::kUnknown) {
      one["reason"] = clock.reason;
    } else {
      one["offset_seconds"] = clock.offset_seconds;
      one["rate"] = 1.0 / clock.time.rate;
    }
    if (clock.source == ClockSource::kMotion) one["uncertainty_seconds"] = clock.deviation_seconds;
    one["evidence"] = clock.evidence;
    one["runner_up_error"] = clock.runner_up > 0.0 ? Json(clock.runner_up) : Json(nullptr);
    clocks.push_back(one);
  }
  return clocks;
}

double LargestViewAngle(const CaptureObservations& capture, const RigEstimate& estimate) {
  double largest = 0.0;
  const int step = std::max(1, capture.frame_count / 100);
  for (int n = 0; n < (capture.static_cameras ? 1 : capture.frame_count); n += step) {
    for (int v = 0; v < capture.view_count(); ++v) {
      for (int w = 0; w < v; ++w) {
        if (!estimate.CameraAt(n, v).valid || !estimate.CameraAt(n, w).valid) continue;
        const double cosine = estimate.CameraAt(n, v).Rotation().row(2).dot(estimate.CameraAt(n, w).Rotation().row(2));
        // Views from opposite sides say as little about depth as views from the same side.
        largest = std::max(largest, std::acos(std::clamp(std::abs(cosine), 0.0, 1.0)));
      }
    }
  }
  return DegFromRad(largest);
}

}  // namespace

CaptureReport MakeReport(const CaptureObservations& capture, const Solution& solution, const WindowsSummary& windows,
                         const std::string& mirror_option) {
  CaptureReport report;
  report.name = capture.name;
  report.static_cameras = capture.static_cameras;
  report.frames = capture.frame_count;
  const std::vector<int> frames = ConsecutiveFrames(0, capture.frame_count);
  std::vector<std::vector<double>> errors(capture.cameras.size());
  std::vector<std::int64_t> outliers(capture.cameras.size(), 0);
  VisitErrors(capture, frames, solution.estimate, [&](int n, int v, int j, double error) {
    errors[static_cast<std::size_t>(v)].push_back(error);
    const double usual = solution.scales.observation.Scatter(j, capture.confidence[capture.Index(n, v, j)]);
    if (error > kOutlierScatters * usual) ++outliers[static_cast<std::size_t>(v)];
  });
  std::vector<double> all;
  for (int v = 0; v < capture.view_count(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    all.insert(all.end(), errors[i].begin(), errors[i].end());
    report.cameras.push_back(DescribeCamera(capture, solution, v, std::move(errors[i]), outliers[i]));
  }
  report.reprojection_percent = 100.0 * Median(std::move(all));
  CountFrames(capture, solution.estimate, windows, report);
  report.unseen_joints = capture.unseen_joints;
  report.calibration = solution.calibration_summary;
  report.windows = windows;
  const std::string failed_windows = DescribeFailedWindows(report);
  if (!failed_windows.empty()) report.warnings.push_back(failed_windows);
  report.largest_view_angle_deg = LargestViewAngle(capture, solution.estimate);
  report.mirror = DescribeMirror(solution, mirror_option);
  report.mirror_sigma = solution.mirror_sigma;
  return report;
}

std::string CaptureReport::Trust() const {
  if (!failure.empty()) return "Nothing was solved, so there is nothing to rely on.";
  // The sum of bone lengths of an adult in the field's skeletons.
  constexpr double kBodyCm = 450.0;
  std::vector<std::string> doubts;
  const auto unused = std::ranges::count_if(cameras, [](const CameraReport& camera) { return !camera.used; });
  if (unused > 0) doubts.push_back(fmt::format("{} of {} cameras are left out", unused, cameras.size()));
  const auto partly = std::ranges::count_if(findings, [](const CameraFinding& finding) { return !finding.corrected; });
  if (partly > unused) doubts.push_back("some stretches of time are left out");
  // Of several people, one comes and another goes.
  const int expected = frames - frames_unseen;
  if (frames_solved < expected) {
    doubts.push_back(fmt::format("{} of {} frames have no pose", expected - frames_solved, expected));
  }
  if (mirror.starts_with("undecided")) doubts.push_back("depth may be mirrored");
  for (const CameraReport& camera : cameras) {
    if (camera.used && camera.outlier_percent > kManyOutliersPercent) {
      doubts.push_back(fmt::format("{:.0f} % of {}'s keypoints do not fit", camera.outlier_percent, camera.name));
    }
  }
  if (!warnings.empty()) doubts.push_back("see the warnings above");
  const std::string agreement = fmt::format("the cameras agree to {:.1f} cm (for an adult, in the median)",
                                            reprojection_percent * kBodyCm / 100.0);
  if (doubts.empty()) return fmt::format("Nothing speaks against this result: {}.", agreement);
  return fmt::format("Use it with care: {}; otherwise {}.", fmt::join(doubts, ", "), agreement);
}

std::string CaptureReport::Contradiction() const {
  const double limit = agrees_poorly ? kManyOutliersPercent : kContradictingOutliersPercent;
  std::size_t used = 0;
  std::vector<std::string> contradicting;
  for (const CameraReport& camera : cameras) {
    if (!camera.used) continue;
    ++used;
    if (camera.outlier_percent > limit) {
      contradicting.push_back(fmt::format("{:.0f} % of {}'s keypoints", camera.outlier_percent, camera.name));
    }
  }
  if (used < 3 || 2 * contradicting.size() < used) return "";
  return fmt::format(
      "the cameras do not agree, and nothing says which are wrong: {} do not fit; do all show the same person, at the "
      "same time and frame rate? Import it again without the wrong ones",
      fmt::join(contradicting, ", "));
}

std::string SolveReport::Doubt() const {
  std::vector<std::string> guesses;
  for (const CaptureReport& capture : captures) {
    if (capture.mirror_is_a_guess) guesses.push_back(capture.name);
  }
  if (guesses.empty()) return "";
  return fmt::format(
      "which way round depth is could not be decided for {}, and what solving started from does not know it either: "
      "look at the poses, and solve again with `mirror=keep` if they are right, or `mirror=flip`",
      fmt::join(guesses, ", "));
}

std::string SolveReport::ToText() const {
  std::string text;
  for (const PeopleReport& scene : people) text += DescribePeople(scene);
  for (const CaptureReport& capture : captures) {
    text += fmt::format("{} ({} cameras)\n", capture.name, capture.static_cameras ? "static" : "moving");
    if (!capture.failure.empty()) {
      text += fmt::format("  not solved: {}\n", capture.failure);
      text += DescribeClocks(capture);
      for (const CameraFinding& finding : capture.findings) text += fmt::format("  found: {}\n", finding.text);
      continue;
    }
    text += fmt::format("  frames      {} of {} solved; {} seen by fewer than two cameras\n", capture.frames_solved,
                        capture.frames, capture.frames_too_few_views);
    text +=
        fmt::format("  keypoints   off by {:.2f} % of the body's bone length (median)\n", capture.reprojection_percent);
    text += fmt::format("  mirror      {} ({:.1f} standard errors)\n", capture.mirror, capture.mirror_sigma);
    for (const CameraReport& camera : capture.cameras) {
      text += camera.used
                  ? fmt::format("  {:<11} focal length {:.0f} px, off by {:.2f} %, {:.1f} % outliers\n", camera.name,
                                camera.focal_px, camera.reprojection_percent, camera.outlier_percent)
                  : fmt::format("  {:<11} not used{}{}\n", camera.name, camera.why_not_used.empty() ? "" : ": ",
                                camera.why_not_used);
    }
    for (const CameraReport& camera : capture.cameras) {
      if (!camera.used || std::abs(camera.corner_shift_px) < kNegligiblePx) continue;
      text += fmt::format("  {:<11} the lens moves the corner of the image {} by {:.0f} px\n", camera.name,
                          camera.corner_shift_px < 0.0 ? "inwards" : "outwards", std::abs(camera.corner_shift_px));
    }
    text += DescribeClocks(capture);
    for (const OffsetReport& offset : capture.offsets) {
      text += fmt::format("  {:<11} {} frames {} than the others in clip {}\n", offset.camera, std::abs(offset.frames),
                          offset.frames < 0 ? "later" : "earlier", offset.clip + 1);
    }
    for (const CameraFinding& finding : capture.findings) text += fmt::format("  found: {}\n", finding.text);
    text += DescribeWorld(capture);
    text += fmt::format("  left-right swaps corrected: {}\n", capture.swaps_corrected);
    if (!capture.unseen_joints.empty()) {
      text +=
          fmt::format("  not in the result: {} (no camera ever sees them)\n", fmt::join(capture.unseen_joints, ", "));
    }
    for (const std::string& warning : capture.warnings) text += fmt::format("  warning: {}\n", warning);
    text += fmt::format("  {}\n", capture.Trust());
  }
  return text;
}

std::string SolveReport::ToJson() const {
  Json json;
  if (!people.empty()) {
    json["people"] = Json::array();
    for (const PeopleReport& scene : people) json["people"].push_back(PeopleToJson(scene));
  }
  json["captures"] = Json::array();
  for (const CaptureReport& capture : captures) {
    Json cameras = Json::array();
    for (const CameraReport& camera : capture.cameras) {
      Json one;
      one["name"] = camera.name;
      one["used"] = camera.used;
      if (!camera.why_not_used.empty()) one["why_not_used"] = camera.why_not_used;
      if (camera.used) {
        one["focal_px"] = camera.focal_px;
        one["corner_shift_px"] = camera.corner_shift_px;
        one["reprojection_percent"] = camera.reprojection_percent;
        one["outlier_percent"] = camera.outlier_percent;
      }
      cameras.push_back(one);
    }
    Json one;
    one["name"] = capture.name;
    one["static_cameras"] = capture.static_cameras;
    one["frames"] = capture.frames;
    one["failure"] = capture.failure;
    if (capture.failure.empty()) {
      one["frames_solved"] = capture.frames_solved;
      one["frames_too_few_views"] = capture.frames_too_few_views;
      one["frames_unseen"] = capture.frames_unseen;
      one["frames_in_failed_windows"] = capture.frames_in_failed_windows;
      one["reprojection_percent"] = capture.reprojection_percent;
      one["largest_view_angle_deg"] = capture.largest_view_angle_deg;
      one["mirror"] = capture.mirror;
      one["mirror_sigma"] = capture.mirror_sigma;
      one["mirror_is_a_guess"] = capture.mirror_is_a_guess;
      one["cameras"] = cameras;
      one["swaps_mended"] = capture.swaps_corrected;
      one["offsets"] = Json::array();
      for (const OffsetReport& offset : capture.offsets) {
        one["offsets"].push_back({{"clip", offset.clip}, {"camera", offset.camera}, {"frames", offset.frames}});
      }
    }
    one["clocks"] = ClocksToJson(capture);
    if (capture.failure.empty()) one["world"] = WorldToJson(capture);
    one["findings"] = Json::array();
    for (const CameraFinding& finding : capture.findings) {
      one["findings"].push_back({{"camera", finding.camera},
                                 {"clip", finding.clip},
                                 {"kind", finding.kind},
                                 {"first_frame", finding.first_frame},
                                 {"frames", finding.frames},
                                 {"corrected", finding.corrected},
                                 {"text", finding.text}});
    }
    one["unseen_joints"] = capture.unseen_joints;
    one["trust"] = capture.Trust();
    one["calibration"] = AdjustmentToJson(capture.calibration);
    one["windows"] = WindowsToJson(capture.windows);
    one["warnings"] = capture.warnings;
    json["captures"].push_back(one);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace canonpose
