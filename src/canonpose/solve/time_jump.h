// Frames that a camera lost in the middle of a clip: from there on it is early.
#pragma once

#include <optional>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

struct TimeJump {
  BadStretch stretch;  ///< the beginning or end of a clip, in its frames; fault kTimeJump
  double gain = 0.0;   ///< by how much it lowers the cost of a keypoint, summed over the frames of the stretch
};

/// The beginning or end of a clip in which a static view shows what the others show a little, at most 2.5 s, later or
/// earlier, while it is in step in the rest. Nothing unless that explains these keypoints clearly better than another
/// position of the camera would. Needs three valid views, and at least 1.5 s on each side.
std::optional<TimeJump> FindTimeJump(const CaptureObservations& capture, const Solution& solution, int clip, int view);

}  // namespace canonpose
