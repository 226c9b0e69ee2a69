#include "canonpose/solve/solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/solved_world.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/image_size.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/invented.h"
#include "canonpose/solve/lens_estimation.h"
#include "canonpose/solve/serial_linear_algebra.h"
#include "canonpose/solve/swaps.h"
#include "canonpose/solve/view_signs.h"
#include "canonpose/solve/windows.h"
#include "canonpose/solve/write_solution.h"

namespace canonpose {
namespace {

/// Enough to see whether cameras agree.
constexpr int kQuickFrames = 120;
constexpr int kQuickIterations = 25;
/// Of all keypoints. Fewer, when removed, change no camera: they hardly counted, being far off. A limb that one of four
/// cameras invents is 3 %.
constexpr double kInventedThatMatter = 0.005;

/// A start from wide lenses has won where the error is below this multiple.
constexpr double kGainOfWideLens = 0.9;

CalibrationOptions Quick(CalibrationOptions options) {
  options.frames = kQuickFrames;
  options.max_iterations = kQuickIterations;
  return options;
}

/// A capture between the stages.
struct CaptureWork {
  CaptureReport report;
  Synchronisation synchronisation;
  std::optional<CameraCheck> check;
  Solution solution;
  WindowsSummary windows;
};

/// Whether moving cameras explain the first clip of a static capture far better: at half of the median error, `error`,
/// that static cameras leave.
bool SeemsToMove(const CaptureObservations& capture, double error, const CalibrationOptions& options) {
  constexpr double kClearlyBetter = 0.5;
  CaptureObservations clip = SingleClip(capture, 0);
  clip.static_cameras = false;
  if (static_cast<int>(FramesWithStart(clip).size()) < kMinFrames) return false;
  const Solution moving = CalibrateMoving(clip, options);
  return moving.calibration_summary.IsUsable() && MedianError(clip, moving) < kClearlyBetter * error &&
         Implausible(MeasurePlausibility(clip, moving)).empty();
}

/// Finds static cameras. Those of wide lenses near the person may not be found from the focal length of a normal lens:
/// where cameras do not fit, the search begins from a wide one, too, and stays with it if it fits better.
Solution ChooseLens(const CaptureObservations& capture, CalibrationOptions& options) {
  Solution normal = CalibrateStatic(capture, options);
  if (normal.calibration_summary.IsUsable() && !AnyAlarm(MeasureSigns(capture, normal))) return normal;
  CalibrationOptions wide = options;
  wide.first_focal = kWideLens;
  Solution other = CalibrateStatic(capture, wide);
  if (!FitsBetter(capture, other, normal, kGainOfWideLens)) return normal;
  options = wide;
  return other;
}

/// Finds the lenses before the cameras are checked, since strong distortion looks like cameras that do not fit. If they
/// do not fit with the lenses either, something else is wrong, by which the lenses were found: then everything stays as
/// it is. Returns whether the lenses are as the keypoints show.
bool FindLensesOfGoodCameras(std::span<const int> frames, const std::vector<int>& lens_of_view,
                             const Calibrate& calibrate, CaptureObservations& capture, Solution& solution) {
  CaptureObservations undistorted = capture;
  Solution found = solution;
  if (!FindLenses(frames, lens_of_view, calibrate, undistorted, found)) return true;
  if (AnyAlarm(MeasureSigns(undistorted, found))) return false;
  capture = std::move(undistorted);
  solution = std::move(found);
  return true;
}

bool HasFailed(const CaptureWork& work) { return !work.report.failure.empty(); }

/// Looks for views that do not fit the others and corrects them, or sets the failure in the report.
void CheckViews(CaptureObservations& capture, const CalibrationOptions& options, const Calibrate& calibrate,
                const Calibrate& calibrate_quickly, CaptureWork& work) {
  const CaptureObservations recorded = capture;
  const double error = MedianError(capture, work.solution);
  work.check = CheckCameras(capture, calibrate, calibrate_quickly, work.solution);
  work.report.findings = MakeFindings(capture, *work.check);
  // Two moving cameras explain nearly anything, and two that are taken to stand still nearly as much.
  if (!capture.static_cameras || capture.view_count() <= 2) return;
  const auto left = std::ranges::count(work.check->dropped, false);
  const bool is_doubtful =
      left <= 2 || (work.solution.calibration_summary.IsUsable() && AnyAlarm(MeasureSigns(capture, work.solution)));
  if (!is_doubtful) return;
  if (SeemsToMove(recorded, error, options)) {
    work.report.failure =
        "the cameras seem to move, but the recording says that they stand still; import it with `moving`";
  }
}

/// Checks the views, and finds the lenses of those that fit.
void CheckViewsAndLenses(CaptureObservations& capture, const SolveOptions& options,
                         const CalibrationOptions& calibration, const Calibrate& calibrate,
                         const Calibrate& calibrate_quickly, CaptureWork& work) {
  if (options.distortion == "none") {
    CheckViews(capture, calibration, calibrate, calibrate_quickly, work);
    return;
  }
  const std::vector<int> lens_of_view = LensOfViews(capture, options.same_lens);
  const bool has_lenses =
      FindLensesOfGoodCameras(CalibrationFrames(capture, calibration), lens_of_view, calibrate, capture, work.solution);
  const CaptureObservations before_check = capture;
  CheckViews(capture, calibration, calibrate, calibrate_quickly, work);
  if (HasFailed(work) || !work.solution.calibration_summary.IsUsable()) return;
  if (has_lenses && HasSameKeypoints(capture, before_check)) return;
  FindLenses(CalibrationFrames(capture, calibration), lens_of_view, calibrate, capture, work.solution);
}

/// Finds the cameras of a capture, or sets the failure in the report. Corrects `capture`: views that are out of step
/// are shifted, those that show somebody else removed. `tell` hears what is being done.
///
/// `was_told_apart`: that the cameras show the same people has been found person by person (identities.h). A person
/// whom others hide from a camera must not cost everybody that camera, so none is left out.
void FindCameras(CaptureObservations& capture, const SolveOptions& options, bool was_told_apart,
                 const std::function<void(const std::string&)>& tell, CaptureWork& work) {
  work.report.name = capture.name;
  work.report.static_cameras = capture.static_cameras;
  work.report.frames = capture.frame_count;
  const auto calibrate_with = [](const CaptureObservations& some, const CalibrationOptions& how) {
    return some.static_cameras ? CalibrateStatic(some, how) : CalibrateMoving(some, how);
  };
  CalibrationOptions calibration{options.mirror, options.calibration_frames, ThreadsToUse(options.threads)};
  const Calibrate calibrate = [&](const CaptureObservations& some) { return calibrate_with(some, calibration); };
  const Calibrate calibrate_for_clocks = [&](const CaptureObservations& some) {
    tell("synchronising the cameras");
    ThrowIfStopRequested();
    CalibrationOptions quick = Quick(calibration);
    // Which way round depth is hardly changes how well clocks fit.
    if (quick.mirror == "auto") quick.mirror = "keep";
    return calibrate_with(some, quick);
  };
  int trials = 0;
  const Calibrate calibrate_quickly = [&](const CaptureObservations& some) {
    tell(fmt::format("cameras do not fit, trial {}", ++trials));
    ThrowIfStopRequested();
    return calibrate_with(some, Quick(calibration));
  };
  work.synchronisation = Synchronise(capture, options.offsets, calibrate_for_clocks);
  work.report.clocks = work.synchronisation.clocks;
  work.report.failure = work.synchronisation.failure;
  if (!HasFailed(work)) work.report.failure = MissingInput(capture);
  if (HasFailed(work)) return;
  work.solution = capture.static_cameras ? ChooseLens(capture, calibration) : calibrate(capture);
  const AdjustmentSummary& summary = work.solution.calibration_summary;
  if (summary.IsUsable()) CorrectImageSizes(capture, calibrate, calibrate_quickly, work.solution);
  if (was_told_apart) {
    work.check.emplace(capture);
    if (summary.IsUsable() && options.distortion != "none") {
      FindLenses(CalibrationFrames(capture, calibration), LensOfViews(capture, options.same_lens), calibrate, capture,
                 work.solution);
    }
  } else if (summary.IsUsable()) {
    CheckViewsAndLenses(capture, options, calibration, calibrate, calibrate_quickly, work);
  }
  if (HasFailed(work)) return;
  // Only now: in a view that does not fit as a whole, any keypoint seems invented.
  if (summary.IsUsable()) {
    const int removed = RemoveInvented(CalibrationFrames(capture, calibration), work.solution, capture);
    const double share = removed / static_cast<double>(capture.confidence.size());
    if (share > kInventedThatMatter) work.solution = calibrate(capture);
  }
  work.report.calibration = summary;
  if (!summary.IsUsable()) work.report.failure = fmt::format("the cameras could not be found: {}", summary.reason);
}

/// Captures of moving cameras are single clips, so a subject's bone lengths are better known from all of its clips
/// together.
void PoolBones(const std::vector<CaptureObservations>& captures, std::vector<CaptureWork>& works) {
  const auto takes_part = [&](std::size_t c) { return !captures[c].static_cameras && !HasFailed(works[c]); };
  std::map<std::string, std::vector<std::vector<double>>> of_subject;  // (clips, J)
  for (std::size_t c = 0; c < captures.size(); ++c) {
    if (!takes_part(c)) continue;
    of_subject[captures[c].subjects.front()].push_back(works[c].solution.estimate.log_bone_lengths.front());
  }
  for (std::size_t c = 0; c < captures.size(); ++c) {
    if (!takes_part(c)) continue;
    const auto& clips = of_subject[captures[c].subjects.front()];
    std::vector<double>& lengths = works[c].solution.estimate.log_bone_lengths.front();
    for (std::size_t j = 0; j < lengths.size(); ++j) {
      std::vector<double> found;
      for (const std::vector<double>& clip : clips) {
        if (std::isfinite(clip[j])) found.push_back(clip[j]);
      }
      lengths[j] = Median(std::move(found));
    }
  }
}

/// Why a view has no camera though nothing contradicts it; empty where that is not known.
std::string WhyNotUsable(const CaptureObservations& capture, int view) {
  bool shows_root = false;
  bool shows_anything = false;
  for (int n = 0; n < capture.frame_count; ++n) {
    shows_root = shows_root || capture.Sees(n, view, capture.skeleton.root);
    for (int j = 0; j < capture.joint_count(); ++j) shows_anything = shows_anything || capture.Sees(n, view, j);
  }
  if (!shows_anything) return "never shows the person";
  if (shows_root) return "";
  return fmt::format("never shows {}, the joint that poses are centred on",
                     capture.skeleton.joints[static_cast<std::size_t>(capture.skeleton.root)]);
}

/// The report of a capture that was solved.
void FinishReport(const CaptureObservations& capture, const SolveOptions& options, int swaps_corrected,
                  CaptureWork& work) {
  const Solution& solution = work.solution;
  const CameraCheck& check = *work.check;
  CaptureReport& report = work.report;
  report = MakeReport(capture, solution, work.windows, options.mirror);
  report.clocks = work.synchronisation.clocks;
  report.swaps_corrected = swaps_corrected;
  for (std::size_t v = 0; v < capture.cameras.size(); ++v) {
    if (check.dropped[v]) report.cameras[v].why_not_used = check.why_dropped[v];
    const ViewClockEstimate* clock = work.synchronisation.Find(0, capture.cameras[v].name);
    if (clock != nullptr && !report.cameras[v].used) report.cameras[v].why_not_used = clock->reason;
    if (!report.cameras[v].used && report.cameras[v].why_not_used.empty()) {
      report.cameras[v].why_not_used = WhyNotUsable(capture, static_cast<int>(v));
    }
    for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
      const ViewCorrection& correction = check.corrections[clip][v];
      const bool is_shifted = correction.reading.time.rate == 1.0;
      const int frames = correction.offset_frames + (is_shifted ? static_cast<int>(correction.reading.time.offset) : 0);
      if (frames != 0) report.offsets.push_back({static_cast<int>(clip), capture.cameras[v].name, frames});
    }
  }
  report.findings = MakeFindings(capture, check);
  const std::string doubt = Doubtful(MeasurePlausibility(capture, solution));
  report.agrees_poorly = !doubt.empty();
  if (report.agrees_poorly) report.warnings.push_back(doubt);
  if (options.mirror == "auto" && std::abs(solution.mirror_sigma) < kDecisiveSigma) {
    report.warnings.emplace_back(
        "perspective is too weak to decide between the poses and their mirror images in depth; depth is as in the "
        "start's poses");
  }
}

void TriangulateAllFrames(const CaptureObservations& capture, Solution& solution) {
  const std::vector<int> frames = ConsecutiveFrames(0, capture.frame_count);
  for (const int frame : frames) {
    TriangulateFrame(capture, frame, solution.scales, solution.mirrored, solution.estimate);
  }
  solution.scales.observation = MeasureNoise(capture, frames, solution.estimate);
}

/// Solves all frames in windows and adds to the report how that went. If all windows fail, the capture fails.
void AdjustAllFrames(const CaptureObservations& capture, const SolveOptions& options, CaptureWork& work) {
  const std::vector<FailedWindow> failed_before = std::move(work.windows.failed);
  work.windows = SolveWindows(capture, options.window_frames, ThreadsToUse(options.threads), work.solution);
  work.windows.AddFailed(failed_before);
  work.report.windows = work.windows;
  if (!work.windows.AllFailed()) return;
  work.report.failure = fmt::format("no frame could be solved: {}", work.windows.failed.front().reason);
}

/// Solves every frame of a capture whose cameras are known. Corrects left-right swaps in `capture`.
void SolveAllFrames(CaptureObservations& capture, const SolveOptions& options, CaptureWork& work) {
  const auto solve_frames = [&] {
    capture.static_cameras ? TriangulateAllFrames(capture, work.solution) : AdjustAllFrames(capture, options, work);
  };
  solve_frames();
  if (HasFailed(work)) return;
  work.report.failure = Implausible(MeasurePlausibility(capture, work.solution));
  if (HasFailed(work)) return;
  const int swaps = CorrectSwaps(capture, work.solution, ThreadsToUse(options.threads));
  if (swaps > 0) solve_frames();
  if (capture.static_cameras) {
    work.solution.scales.acceleration = MeasureAccelerations(capture, work.solution.estimate);
    AdjustAllFrames(capture, options, work);
  }
  if (HasFailed(work)) return;
  FinishReport(capture, options, swaps, work);
  work.report.failure = work.report.Contradiction();
}

/// What is known of the sizes in a capture.
WorldMeasures MeasuresOf(const CaptureObservations& capture, const SolveOptions& options, const Dataset& dataset) {
  if (options.calibrated_scale) {
    if (!capture.static_cameras) return {};
    for (const ClipRange& clip : capture.clips) {
      WorldMeasures measures = DistancesOfCalibration(dataset.sequences[clip.sequence]);
      if (!measures.distances.empty()) return measures;
    }
    return {};
  }
  return MeasuresIn(dataset.sequences[capture.clips.front().sequence], options.measures);
}

/// Places a solved capture in the real world and says so in the report.
void PlaceCapture(const CaptureObservations& capture, const SolveOptions& options, Dataset& dataset,
                  CaptureReport& report) {
  std::vector<std::size_t> sequences;
  for (const ClipRange& clip : capture.clips) sequences.push_back(clip.sequence);
  PlaceSolvedInWorld(sequences, MeasuresOf(capture, options, dataset), dataset);
  for (const std::size_t index : sequences) {
    const Sequence& sequence = dataset.sequences[index];
    if (!sequence.solved_world.up.is_known()) continue;
    report.world = sequence.solved_world;
    report.unit = sequence.cameras.front().solved.unit;
  }
  if (!options.measures.distances.empty() && !report.world.scale.is_known()) {
    report.warnings.emplace_back("the cameras whose distance is known were not solved, so that the scale is not known");
  }
  if (options.calibrated_scale && !report.world.scale.is_known()) {
    report.warnings.emplace_back(
        "no two static cameras are both calibrated and solved, so that the calibration does not "
        "tell the scale");
  }
}

/// Throws Error(kInvalidArgument) where cameras that share a lens are not cameras of the dataset, or are named twice.
void RequireSameLens(const Dataset& dataset, const std::vector<std::vector<std::string>>& same_lens) {
  if (same_lens.size() == 1 && same_lens.front() == std::vector<std::string>{"all"}) return;
  std::set<std::string> cameras;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) cameras.insert(view.name);
  }
  std::set<std::string> named;
  for (const std::vector<std::string>& group : same_lens) {
    if (group.size() < 2) {
      ThrowInvalidArgument("`same_lens`: expected two cameras or more, as in cam1,cam2, or all, found {}",
                           fmt::join(group, ","));
    }
    for (const std::string& camera : group) {
      if (!cameras.contains(camera)) {
        ThrowInvalidArgument("`same_lens`: expected cameras of the data ({}), found {}", fmt::join(cameras, ", "),
                             camera);
      }
      if (!named.insert(camera).second) {
        ThrowInvalidArgument("`same_lens`: expected every camera once, found {} twice", camera);
      }
    }
  }
}

/// Throws, with the reason of each, where no capture was solved.
void RequireOneSolved(const SolveReport& report) {
  std::string reasons;
  for (const CaptureReport& capture : report.captures) {
    if (capture.failure.empty()) return;
    if (!reasons.empty()) reasons += "; ";
    reasons += fmt::format("{}: {}", capture.name, capture.failure);
  }
  ThrowComputation("nothing could be solved: {}", reasons);
}

}  // namespace

void SolveOptions::Validate() const {
  if (mirror != "auto" && mirror != "keep" && mirror != "flip") {
    ThrowInvalidArgument("`mirror`: expected one of auto, keep, flip, found \"{}\"", mirror);
  }
  const std::array<bool, 3> given = {!measures.heights.empty(), !measures.distances.empty(), calibrated_scale};
  if (std::ranges::count(given, true) > 1) {
    ThrowInvalidArgument(
        "`height`, `camera_distance` and `calibrated_scale` each say how large the scene is; give one of them");
  }
  if (distortion != "auto" && distortion != "none") {
    ThrowInvalidArgument("`distortion`: expected auto or none, found \"{}\"", distortion);
  }
  for (const auto& [camera, seconds] : offsets) {
    if (std::isfinite(seconds)) continue;
    ThrowInvalidArgument("`offset`: expected seconds for {}, found {}", camera, seconds);
  }
  if (threads < 0) ThrowInvalidArgument("`threads`: expected 0 or more, found {}", threads);
  CANONPOSE_CHECK(calibration_frames > 0 && window_frames > 0, "{} {}", calibration_frames, window_frames);
}

void SolveOptions::RequireSizesOf(const Dataset& dataset) const {
  RequireMeasuresOf(dataset, measures);
  RequireSameLens(dataset, same_lens);
  if (!calibrated_scale || dataset.HasCalibration()) return;
  ThrowInvalidArgument(
      "`calibrated_scale`: expected data that were imported with a calibration, found none; give a `height` or a "
      "`camera_distance` instead");
}

void SolveOptions::RequireCamerasOf(const Dataset& dataset) const {
  std::set<std::string> names;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) names.insert(view.name);
  }
  for (const auto& [camera, seconds] : offsets) {
    if (names.contains(camera)) continue;
    ThrowInvalidArgument("`offset`: expected cameras of the data ({}), found {}", fmt::join(names, ", "), camera);
  }
  if (offsets.empty() || offsets.size() < names.size()) return;
  ThrowInvalidArgument(
      "`offset`: expected one camera without any, from which the others count, found one of each of {}",
      fmt::join(names, ", "));
}

SolveReport Solve(Dataset& dataset, const StartPoses& start, const SolveOptions& options) {
  options.Validate();
  options.RequireSizesOf(dataset);
  options.RequireCamerasOf(dataset);
  const OneBlasThread one_thread;
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      view.solved = {};
      view.solved_calibration.clear();
      view.time_offset_seconds = 0.0;
      view.solved_frames = {};
    }
    sequence.solved_world = {};
  }
  std::vector<CaptureObservations> captures = CollectCaptures(dataset, start);
  Progress progress("solve", static_cast<long>(2 * captures.size()));
  long done = 0;
  std::vector<CaptureWork> works(captures.size());
  for (std::size_t c = 0; c < captures.size(); ++c) {
    ThrowIfStopRequested();
    const auto tell = [&](const std::string& what) { progress.Update(done, captures[c].name + ", " + what); };
    tell("cameras");
    const bool was_told_apart = !dataset.sequences[captures[c].clips.front().sequence].scene.empty();
    FindCameras(captures[c], options, was_told_apart, tell, works[c]);
    ++done;
  }
  PoolBones(captures, works);
  SolveReport report;
  for (std::size_t c = 0; c < captures.size(); ++c) {
    ThrowIfStopRequested();
    progress.Update(done++, captures[c].name + ", all frames");
    if (!HasFailed(works[c])) SolveAllFrames(captures[c], options, works[c]);
    if (!HasFailed(works[c])) {
      works[c].report.mirror_is_a_guess = works[c].report.mirror.starts_with("undecided") && !start.knows_depth_sign;
      WriteSolution(captures[c], works[c].solution, *works[c].check, works[c].synchronisation.times, dataset);
      PlaceCapture(captures[c], options, dataset, works[c].report);
    } else {
      WriteNothing(captures[c], dataset);
    }
    report.captures.push_back(std::move(works[c].report));
    works[c] = {};
  }
  RequireOneSolved(report);
  return report;
}

}  // namespace canonpose
