#include "canonpose/solve/solver.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <dlfcn.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/windows.h"

namespace canonpose {
namespace {

/// Matrices of a sparse factorisation are small: OpenBLAS's own threads would only wait for each other.
class OneLinearAlgebraThread {
 public:
  OneLinearAlgebraThread() {
    const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
    set_ = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    if (get == nullptr || set_ == nullptr) return;
    before_ = get();
    set_(1);
  }
  ~OneLinearAlgebraThread() {
    if (before_ > 0) set_(before_);
  }
  OneLinearAlgebraThread(const OneLinearAlgebraThread&) = delete;
  OneLinearAlgebraThread& operator=(const OneLinearAlgebraThread&) = delete;

 private:
  void (*set_)(int) = nullptr;
  int before_ = 0;
};

Solution Calibrate(const CaptureObservations& capture, const SolveOptions& options) {
  const CalibrationOptions calibration{options.mirror, options.calibration_frames, ThreadsToUse(options.threads)};
  return capture.static_cameras ? CalibrateStatic(capture, calibration) : CalibrateMoving(capture, calibration);
}

/// Captures of moving cameras are single clips: a subject's bones are known better from all of its clips together.
void PoolBones(const std::vector<CaptureObservations>& captures, std::vector<Solution>& solutions) {
  std::map<std::string, std::vector<std::vector<double>>> of_subject;  // (clips, J)
  for (std::size_t c = 0; c < captures.size(); ++c) {
    if (captures[c].static_cameras) continue;
    of_subject[captures[c].subjects.front()].push_back(solutions[c].estimate.log_bone_lengths.front());
  }
  for (std::size_t c = 0; c < captures.size(); ++c) {
    if (captures[c].static_cameras) continue;
    const auto& clips = of_subject[captures[c].subjects.front()];
    std::vector<double>& lengths = solutions[c].estimate.log_bone_lengths.front();
    for (std::size_t j = 0; j < lengths.size(); ++j) {
      std::vector<double> found;
      for (const std::vector<double>& clip : clips) {
        if (std::isfinite(clip[j])) found.push_back(clip[j]);
      }
      lengths[j] = Median(std::move(found));
    }
  }
}

void SolveAllFrames(const CaptureObservations& capture, const SolveOptions& options, Solution& solution) {
  if (capture.static_cameras) {
    std::vector<int> frames(static_cast<std::size_t>(capture.frame_count));
    std::iota(frames.begin(), frames.end(), 0);
    for (const int frame : frames) {
      TriangulateFrame(capture, frame, solution.scales, solution.mirrored, solution.estimate);
    }
    solution.scales.observation = MeasureNoise(capture, frames, solution.estimate);
    solution.scales.acceleration = MeasureAccelerations(capture, solution.estimate);
  }
  SolveWindows(capture, options.window_frames, ThreadsToUse(options.threads), solution);
}

Camera CameraOf(const CaptureObservations& capture, const RigEstimate& estimate, int frame, int view) {
  const ObservedCamera& observed = capture.cameras[static_cast<std::size_t>(view)];
  const CameraEstimate& found = estimate.CameraAt(frame, view);
  Camera camera;
  const double focal_px = found.Focal() * observed.diagonal_px;
  camera.K << focal_px, 0, 0.5 * observed.image_size_px[0], 0, focal_px, 0.5 * observed.image_size_px[1], 0, 0, 1;
  camera.camera_from_world_rotation = found.Rotation();
  camera.camera_from_world_translation_mm = estimate.Translation(frame, view);
  return camera;
}

/// The frame nearest to `frame` in a clip whose camera is known; -1 where there is none.
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

void WriteView(const CaptureObservations& capture, const Solution& solution, const std::vector<float>& uncertainty,
               const ClipRange& clip, int v, CameraView& view) {
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  const std::size_t values = static_cast<std::size_t>(clip.count) * joints;
  view.solved.assign(3 * values, std::nanf(""));
  view.solved_uncertainty.assign(values, std::nanf(""));
  for (int t = 0; t < clip.count; ++t) {
    const int frame = clip.first + t;
    if (!solution.estimate.CameraAt(frame, v).valid) continue;
    for (std::size_t j = 0; j < joints; ++j) {
      const Eigen::Vector3d p = solution.estimate.InCamera(frame, v, static_cast<int>(j));
      if (!p.allFinite()) continue;
      const std::size_t i = static_cast<std::size_t>(t) * joints + j;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        view.solved[3 * i + axis] = static_cast<float>(p[static_cast<Eigen::Index>(axis)]);
      }
      view.solved_uncertainty[i] = uncertainty[static_cast<std::size_t>(frame) * joints + j];
    }
  }
  WriteCameras(capture, solution.estimate, clip, v, view);
}

void WriteSolution(const CaptureObservations& capture, const Solution& solution, Dataset& dataset) {
  std::vector<float> uncertainty;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      uncertainty.push_back(static_cast<float>(JointUncertainty(capture, n, j, solution)));
    }
  }
  for (const ClipRange& clip : capture.clips) {
    for (CameraView& view : dataset.sequences[clip.sequence].cameras) {
      const auto camera = std::ranges::find(capture.cameras, view.name, &ObservedCamera::name);
      WriteView(capture, solution, uncertainty, clip, static_cast<int>(camera - capture.cameras.begin()), view);
    }
  }
}

}  // namespace

void SolveOptions::Validate() const {
  if (mirror != "auto" && mirror != "keep" && mirror != "flip") {
    ThrowUsage("--mirror: expected one of auto, keep, flip, found \"{}\"", mirror);
  }
  if (threads < 0) ThrowUsage("--threads: expected 0 or more, found {}", threads);
  CANONPOSE_CHECK(calibration_frames > 0 && window_frames > 0, "{} {}", calibration_frames, window_frames);
}

SolveReport Solve(Dataset& dataset, const StartPoses& start, const SolveOptions& options) {
  options.Validate();
  const OneLinearAlgebraThread one_thread;
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      view.solved.clear();
      view.solved_uncertainty.clear();
      view.solved_calibration.clear();
    }
  }
  const std::vector<CaptureObservations> captures = CollectCaptures(dataset, start);
  SolveReport report;
  Progress progress("solve", static_cast<long>(2 * captures.size()));
  long done = 0;
  std::vector<Solution> solutions;
  for (const CaptureObservations& capture : captures) {
    progress.Update(done++, capture.name + ", cameras");
    solutions.push_back(Calibrate(capture, options));
  }
  PoolBones(captures, solutions);
  for (std::size_t c = 0; c < captures.size(); ++c) {
    progress.Update(done++, captures[c].name + ", all frames");
    SolveAllFrames(captures[c], options, solutions[c]);
    WriteSolution(captures[c], solutions[c], dataset);
    report.captures.push_back(MakeReport(captures[c], solutions[c], options.mirror));
    solutions[c].estimate = {};
  }
  return report;
}

}  // namespace canonpose
