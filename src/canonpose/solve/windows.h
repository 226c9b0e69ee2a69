// Solves all frames of a capture in overlapping windows of time, with what calibration found.
#pragma once

#include <string>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// A window whose adjustment failed, so that its frames are not solved.
struct FailedWindow {
  int clip = 0;         ///< of the capture
  int first_frame = 0;  ///< of the clip
  int frame_count = 0;
  std::string reason;  ///< AdjustmentSummary::reason
};

/// How the adjustments of all windows went. Windows without a joint are neither adjusted nor counted.
struct [[nodiscard]] WindowsSummary {
  int windows = 0;
  int converged = 0;
  int stopped_early = 0;             ///< at the iteration limit
  std::vector<FailedWindow> failed;  ///< in temporal order
  int iterations = 0;                ///< summed over the windows that did not fail, as are the costs
  double initial_cost = 0.0;
  double final_cost = 0.0;

  [[nodiscard]] bool AllFailed() const { return windows > 0 && static_cast<int>(failed.size()) == windows; }
  /// Adds windows that failed in an earlier pass and therefore had no joints in this one.
  void AddFailed(const std::vector<FailedWindow>& earlier);
};

/// Solves every frame: the joints and, where cameras move, the cameras; bone lengths and static cameras stay fixed.
/// Windows have about `window_frames` frames and reach a little into their neighbours, so that motion is as smooth at
/// their edges as elsewhere. They are independent of each other and run in parallel on `threads` threads; the result
/// does not depend on the number of threads. Time and memory are proportional to the number of frames. Where the
/// adjustment of a window fails, its joints become NaN and its moving cameras invalid.
WindowsSummary SolveWindows(const CaptureObservations& capture, int window_frames, int threads, Solution& solution);

}  // namespace canonpose
