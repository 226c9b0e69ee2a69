#include "canonpose/solve/solver.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/serial_linear_algebra.h"
#include "canonpose/solve/swaps.h"
#include "canonpose/solve/windows.h"

namespace canonpose {
namespace {

/// A capture between the stages.
struct CaptureWork {
  CaptureReport report;
  CameraCheck check;
  Solution solution;
  WindowsSummary windows;
};

bool HasFailed(const CaptureWork& work) { return !work.report.failure.empty(); }

/// Finds the cameras of a capture, or sets the failure in the report. Corrects `capture`: views that are out of step
/// are shifted, those that show somebody else removed.
void FindCameras(CaptureObservations& capture, const SolveOptions& options, CaptureWork& work) {
  work.report.name = capture.name;
  work.report.static_cameras = capture.static_cameras;
  work.report.frames = capture.frame_count;
  work.report.failure = MissingInput(capture);
  if (HasFailed(work)) return;
  const CalibrationOptions calibration{options.mirror, options.calibration_frames, ThreadsToUse(options.threads)};
  const Calibrate calibrate = [&](const CaptureObservations& corrected) {
    return corrected.static_cameras ? CalibrateStatic(corrected, calibration) : CalibrateMoving(corrected, calibration);
  };
  work.solution = calibrate(capture);
  if (work.solution.calibration.IsUsable()) work.check = CheckCameras(capture, calibrate, work.solution);
  work.report.calibration = work.solution.calibration;
  if (!work.solution.calibration.IsUsable()) {
    work.report.failure = fmt::format("the cameras could not be found: {}", work.solution.calibration.reason);
  }
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

/// The report of a capture that was solved.
void FinishReport(const CaptureObservations& capture, const SolveOptions& options, int swaps_corrected,
                  CaptureWork& work) {
  const Solution& solution = work.solution;
  const CameraCheck& check = work.check;
  CaptureReport& report = work.report;
  report = MakeReport(capture, solution, work.windows, options.mirror);
  report.swaps_corrected = swaps_corrected;
  for (std::size_t v = 0; v < capture.cameras.size(); ++v) {
    if (check.dropped[v]) report.cameras[v].why_not_used = "does not show the same person, or not at the same time";
    for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
      const int frames = check.offsets[clip][v];
      if (frames != 0) report.offsets.push_back({static_cast<int>(clip), capture.cameras[v].name, frames});
    }
  }
  const std::string doubt = Doubtful(MeasurePlausibility(capture, solution));
  if (!doubt.empty()) report.warnings.push_back(doubt);
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
  if (!HasFailed(work)) FinishReport(capture, options, swaps, work);
}

Camera CameraOf(const CaptureObservations& capture, const RigEstimate& estimate, int frame, int view) {
  const ObservedCamera& observed = capture.cameras[static_cast<std::size_t>(view)];
  const CameraEstimate& found = estimate.CameraAt(frame, view);
  Camera camera;
  const double focal_px = found.Focal() * observed.diagonal_px;
  camera.K << focal_px, 0, 0.5 * observed.image_size_px[0], 0, focal_px, 0.5 * observed.image_size_px[1], 0, 0, 1;
  camera.camera_from_world_rotation = found.Rotation();
  camera.camera_from_world_translation = estimate.Translation(frame, view);
  return camera;
}

/// The frame of a clip nearest to `frame` in which the view's camera is known; -1 where there is none.
int NearestKnownFrame(const RigEstimate& estimate, const ClipRange& clip, int frame, int view) {
  for (int distance = 0; distance < clip.count; ++distance) {
    for (const int n : {frame - distance, frame + distance}) {
      if (n >= clip.first && n < clip.first + clip.count && estimate.CameraAt(n, view).valid) return n;
    }
  }
  return -1;
}

void WriteCameras(const CaptureObservations& capture, const RigEstimate& estimate, const ClipRange& clip, int v,
                  CameraView& view) {
  if (capture.static_cameras) {
    if (estimate.CameraAt(0, v).valid) view.solved_calibration = {CameraOf(capture, estimate, 0, v)};
    return;
  }
  if (NearestKnownFrame(estimate, clip, clip.first, v) < 0) return;
  for (int n = clip.first; n < clip.first + clip.count; ++n) {
    view.solved_calibration.push_back(CameraOf(capture, estimate, NearestKnownFrame(estimate, clip, n, v), v));
  }
}

/// The poses of a view in which no joint was solved.
PoseSequence NothingSolved(const CaptureObservations& capture, const ClipRange& clip, const CameraView& view) {
  PoseSequence solved(capture.skeleton, clip.count);
  solved.unit = LengthUnit::kBodyLengths;
  solved.coordinate_frame = {CoordinateFrame::Kind::kCamera, view.name};
  return solved;
}

void WriteView(const CaptureObservations& capture, const Solution& solution, const std::vector<float>& uncertainty,
               const ClipRange& clip, int v, int offset_frames, CameraView& view) {
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  view.solved = NothingSolved(capture, clip, view);
  for (int t = 0; t < clip.count; ++t) {
    const int frame = clip.first + t + offset_frames;  // the dataset keeps the camera's own time
    if (frame < clip.first || frame >= clip.first + clip.count) continue;
    if (!solution.estimate.CameraAt(frame, v).valid) continue;
    for (std::size_t j = 0; j < joints; ++j) {
      const Eigen::Vector3d p = solution.estimate.InCamera(frame, v, static_cast<int>(j));
      if (!p.cast<float>().allFinite()) continue;
      const std::size_t i = static_cast<std::size_t>(t) * joints + j;
      view.solved.PoseAt(t).row(static_cast<Eigen::Index>(j)) = p.cast<float>().transpose();
      view.solved.standard_deviation()[i] = uncertainty[static_cast<std::size_t>(frame) * joints + j];
    }
  }
  view.solved.TrustKnownJoints();
  WriteCameras(capture, solution.estimate, clip, v, view);
}

void WriteSolution(const CaptureObservations& capture, const Solution& solution, const CameraCheck& check,
                   Dataset& dataset) {
  std::vector<float> uncertainty;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      uncertainty.push_back(static_cast<float>(JointUncertainty(capture, n, j, solution)));
    }
  }
  for (std::size_t c = 0; c < capture.clips.size(); ++c) {
    const ClipRange& clip = capture.clips[c];
    for (CameraView& view : dataset.sequences[clip.sequence].cameras) {
      const int v = capture.FindView(view.name);
      WriteView(capture, solution, uncertainty, clip, v, check.offsets[c][static_cast<std::size_t>(v)], view);
    }
  }
}

/// For a capture that was not solved: missing joints where poses would be.
void WriteNothing(const CaptureObservations& capture, Dataset& dataset) {
  for (const ClipRange& clip : capture.clips) {
    for (CameraView& view : dataset.sequences[clip.sequence].cameras) {
      view.solved = NothingSolved(capture, clip, view);
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
  if (threads < 0) ThrowInvalidArgument("`threads`: expected 0 or more, found {}", threads);
  CANONPOSE_CHECK(calibration_frames > 0 && window_frames > 0, "{} {}", calibration_frames, window_frames);
}

SolveReport Solve(Dataset& dataset, const StartPoses& start, const SolveOptions& options) {
  options.Validate();
  const OneBlasThread one_thread;
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      view.solved = {};
      view.solved_calibration.clear();
    }
  }
  std::vector<CaptureObservations> captures = CollectCaptures(dataset, start);
  Progress progress("solve", static_cast<long>(2 * captures.size()));
  long done = 0;
  std::vector<CaptureWork> works(captures.size());
  for (std::size_t c = 0; c < captures.size(); ++c) {
    ThrowIfStopRequested();
    progress.Update(done++, captures[c].name + ", cameras");
    FindCameras(captures[c], options, works[c]);
  }
  PoolBones(captures, works);
  SolveReport report;
  for (std::size_t c = 0; c < captures.size(); ++c) {
    ThrowIfStopRequested();
    progress.Update(done++, captures[c].name + ", all frames");
    if (!HasFailed(works[c])) SolveAllFrames(captures[c], options, works[c]);
    if (!HasFailed(works[c])) {
      WriteSolution(captures[c], works[c].solution, works[c].check, dataset);
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
