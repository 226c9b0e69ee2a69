// Signs that a view does not fit the others: its keypoints against the joints that the other views triangulate.
#pragma once

#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Distances are in body units, and scaled down where the other views determine a joint less well than a keypoint does.
struct ViewSigns {
  bool known = false;         ///< false where the view has no camera, or nothing to compare
  double disagreement = 0.0;  ///< median over the capture
  double worst_window = 0.0;  ///< the largest median over half a second
  /// Of static cameras: how far, on average, the keypoints lie elsewhere after some frame of a clip than before it. A
  /// pushed camera has this even where the calibration has found a compromise between both positions.
  double largest_step = 0.0;
  double outliers = 0.0;  ///< share of keypoints that are farther off than five times their usual scatter

  /// Whether the view has to be looked at more closely. An alarm by itself is not a finding.
  [[nodiscard]] bool Alarm() const;
};

/// (V) Each view against the joints that the others triangulate, in up to a few hundred frames; with two views against
/// the joints that both triangulate.
std::vector<ViewSigns> MeasureSigns(const CaptureObservations& capture, const Solution& solution);

/// The views that are known, in order.
std::vector<int> KnownViews(const std::vector<ViewSigns>& signs);

bool AnyAlarm(const std::vector<ViewSigns>& signs);

}  // namespace canonpose
