// All frames of a capture, solved in windows of time that overlap and share what calibration has found.
#pragma once

#include <string>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// A window whose adjustment failed: its frames are not solved.
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
  std::vector<FailedWindow> failed;  ///< in the order of time
  int iterations = 0;                ///< the sum over the windows that did not fail; so are the costs
  double initial_cost = 0.0;
  double final_cost = 0.0;

  [[nodiscard]] bool AllFailed() const { return windows > 0 && static_cast<int>(failed.size()) == windows; }
  /// Adds windows that failed in an earlier pass, which this one therefore found without joints.
  void AddFailed(const std::vector<FailedWindow>& earlier);
};

/// Solves every frame: the joints, and the cameras where they move, with bone lengths (and static cameras) as they are.
/// Windows of `window_frames` reach a little into their neighbours, so that a joint near an edge is as smooth as any;
/// they are solved side by side on `threads` threads, each by itself, so that the result does not depend on how many.
/// Memory and time grow with the number of frames. Where the adjustment of a window fails its joints become NaN, and
/// its moving cameras invalid.
WindowsSummary SolveWindows(const CaptureObservations& capture, int window_frames, int threads, Solution& solution);

}  // namespace canonpose
