#include "canonpose/solve/windows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "canonpose/base/parallel.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

constexpr double kWindowLogFocal = 0.1;

/// Frames first .. last - 1 are kept of a window that reaches from `from` to `to` - 1.
struct Window {
  int clip;
  int first;
  int last;
  int from;
  int to;
};

std::vector<Window> MakeWindows(const CaptureObservations& capture, int window_frames, int margin) {
  std::vector<Window> windows;
  for (std::size_t c = 0; c < capture.clips.size(); ++c) {
    const ClipRange& clip = capture.clips[c];
    const int end = clip.first + clip.count;
    // Windows of equal length, rather than a short one at the end.
    const int count = std::max(1, (clip.count + window_frames / 2) / window_frames);
    for (int w = 0; w < count; ++w) {
      const int first = clip.first + static_cast<int>(static_cast<std::int64_t>(w) * clip.count / count);
      const int last = clip.first + static_cast<int>(static_cast<std::int64_t>(w + 1) * clip.count / count);
      windows.push_back(
          {static_cast<int>(c), first, last, std::max(clip.first, first - margin), std::min(end, last + margin)});
    }
  }
  return windows;
}

/// Rotates the world of a slice back to where it was before the adjustment, which determines how cameras move relative
/// to each other and over time but not their common rotation.
void KeepWorld(const RigEstimate& before, RigEstimate& slice) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < slice.cameras.size(); ++c) {
    if (slice.cameras[c].valid) sum += slice.cameras[c].Rotation().transpose() * before.cameras[c].Rotation();
  }
  if (sum.squaredNorm() == 0.0) return;
  const Eigen::Matrix3d slice_from_before = NearestRotation(sum);
  for (CameraEstimate& camera : slice.cameras) camera.SetRotation(camera.Rotation() * slice_from_before);
  for (Eigen::Vector3d& joint : slice.joints) joint = slice_from_before.transpose() * joint;
}

/// Whether any joint of frames first .. last - 1 is known.
bool HasJoints(const RigEstimate& estimate, int first, int last) {
  for (int n = first; n < last; ++n) {
    for (int j = 0; j < estimate.joint_count; ++j) {
      if (estimate.Joint(n, j).allFinite()) return true;
    }
  }
  return false;
}

/// Removes what a failed adjustment leaves unknown: joints and moving cameras.
void Forget(RigEstimate& slice) {
  std::ranges::fill(slice.joints, Eigen::Vector3d::Constant(std::nan("")));
  if (slice.static_cameras) return;
  for (CameraEstimate& camera : slice.cameras) camera.valid = false;
}

/// A window and how its adjustment went.
struct WindowResult {
  RigEstimate estimate;  ///< of the frames that are kept
  bool has_joints = false;
  AdjustmentSummary summary;
};

void Count(const CaptureObservations& capture, const Window& window, const WindowResult& result, WindowsSummary& sum) {
  if (!result.has_joints) return;
  const AdjustmentSummary& one = result.summary;
  ++sum.windows;
  if (!one.IsUsable()) {
    const int clip_begin = capture.clips[static_cast<std::size_t>(window.clip)].first;
    sum.failed.push_back({window.clip, window.first - clip_begin, window.last - window.first, one.reason});
    return;
  }
  ++(one.ending == AdjustmentEnding::kConverged ? sum.converged : sum.stopped_early);
  sum.iterations += one.iterations;
  sum.initial_cost += one.initial_cost;
  sum.final_cost += one.final_cost;
}

}  // namespace

void WindowsSummary::AddFailed(const std::vector<FailedWindow>& earlier) {
  windows += static_cast<int>(earlier.size());
  failed.insert(failed.end(), earlier.begin(), earlier.end());
  std::ranges::sort(failed, {}, [](const FailedWindow& window) { return std::pair(window.clip, window.first_frame); });
}

WindowsSummary SolveWindows(const CaptureObservations& capture, int window_frames, int threads, Solution& solution) {
  AdjustmentOptions options;
  options.scales = solution.scales;
  options.free_bones = false;
  // A window by itself says little about perspective, so the focal lengths stay near those of the calibration.
  options.scales.log_focal = kWindowLogFocal;
  options.free_cameras = !capture.static_cameras;
  options.iterations = capture.static_cameras ? 5 : 20;
  const std::vector<Window> windows = MakeWindows(capture, window_frames, capture.static_cameras ? 8 : 15);
  std::vector<WindowResult> results(windows.size());
  InParallel(static_cast<int>(windows.size()), threads, [&](int w) {
    const Window& window = windows[static_cast<std::size_t>(w)];
    WindowResult& result = results[static_cast<std::size_t>(w)];
    const RigEstimate before = solution.estimate.Slice(window.from, window.to - window.from);
    RigEstimate slice = before;
    result.has_joints = HasJoints(slice, window.first, window.last);
    if (result.has_joints) {
      result.summary = Adjust(capture, ConsecutiveFrames(window.from, window.to - window.from), options, slice);
      if (!result.summary.IsUsable()) {
        Forget(slice);
      } else if (!capture.static_cameras) {
        KeepWorld(before, slice);
      }
    }
    result.estimate = slice.Slice(window.first, window.last - window.first);
  });
  WindowsSummary summary;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    solution.estimate.Adopt(results[w].estimate, windows[w].first, windows[w].last - windows[w].first);
    Count(capture, windows[w], results[w], summary);
  }
  return summary;
}

}  // namespace canonpose
