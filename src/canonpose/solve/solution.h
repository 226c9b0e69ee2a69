// What one stage of the solver hands to the next, and the last one to the report.
#pragma once

#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// An estimate and the scales it was adjusted with.
struct Solution {
  RigEstimate estimate;
  AdjustmentScales scales;
  bool mirrored = false;      ///< found from the mirror of the start's poses
  double mirror_sigma = 0.0;  ///< Preference() over the mirror; see fit.h
  /// How the calibration's last adjustment went, or the first that failed; then the estimate is not a solution.
  AdjustmentSummary calibration_summary{};
};

}  // namespace canonpose
