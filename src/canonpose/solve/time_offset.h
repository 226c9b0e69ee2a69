// The time offset of a camera, in frames.
#pragma once

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// The largest offset, in frames, that is searched for.
inline constexpr int kMaxOffset = 15;

struct OffsetEstimate {
  int frames = 0;     ///< as ShiftView() (camera_check.h) takes them
  double gain = 0.0;  ///< by how much they lower the mean cost of a keypoint
};

/// The time offset at which a view of static cameras fits the others best in a clip; 0 where no other offset is clearly
/// better. `refine`: the view has been shifted already, and any better offset will do.
OffsetEstimate EstimateOffset(const CaptureObservations& capture, const Solution& solution, int clip, int view,
                              bool refine);

}  // namespace canonpose
