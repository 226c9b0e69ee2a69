// What the solver knows of a capture between its stages, and at the end.
#pragma once

#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// An estimate and the scales it was adjusted with.
struct Solution {
  RigEstimate estimate;
  AdjustmentScales scales;
  bool mirrored = false;      ///< found from the depth mirror of the start's poses
  double mirror_sigma = 0.0;  ///< Preference() over the mirrored solution
  /// How the last adjustment of the calibration went, or the first that failed: then the rest is no solution.
  AdjustmentSummary calibration{};
};

}  // namespace canonpose
