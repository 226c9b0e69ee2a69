// Self-calibration: 3D poses and cameras of a recording from its 2D keypoints alone.
//
// Each capture is solved by itself, in three stages: its cameras from some of its frames, starting from poses that a
// lifter or a factorisation found in each view (calibration.h); every frame in windows (windows.h); then what is told
// of it (report.h).
#pragma once

#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/report.h"

namespace canonpose {

struct SolveOptions {
  std::string mirror = "auto";   ///< auto: decided by perspective; keep, flip: of the start's poses, by request
  int calibration_frames = 400;  ///< of a static capture, from which its cameras are found
  int window_frames = 128;       ///< solved at once
  int threads = 0;               ///< 0: as many as the machine has cores; the result does not depend on it

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// Solves every capture of the dataset and writes `solved`, `solved_uncertainty` and `solved_calibration` into it; what
/// was there before is removed. Lengths are in the unit in which the bones of the capture's first subject add up to 1.
///
/// Throws Error(kComputation) where no capture can be solved, saying what is missing.
SolveReport Solve(Dataset& dataset, const StartPoses& start, const SolveOptions& options);

}  // namespace canonpose
