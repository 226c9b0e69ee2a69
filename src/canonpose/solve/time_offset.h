// How many frames a camera is early or late.
#pragma once

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Offsets of up to this many frames are found.
inline constexpr int kMaxOffset = 15;

/// The time offset in frames at which a view of static cameras fits the others best in a clip, 0 where no other one is
/// clearly better. `gain` is how much less the mean cost of a keypoint is.
struct OffsetEstimate {
  int frames = 0;
  double gain = 0.0;
};
/// `refine`: the view was moved already, and is moved on to wherever it fits better at all.
OffsetEstimate EstimateOffset(const CaptureObservations& capture, const Solution& solution, int clip, int view,
                              bool refine);

}  // namespace canonpose
