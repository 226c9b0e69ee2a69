// What a view shows at times between its frames.
#pragma once

#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

/// Replaces what a view shows in a clip of `capture` by what it shows in `recorded`, a capture of the same frames and
/// cameras, at the times of the clip's frames. `time` takes the frames of the view in `recorded` to those of the clip.
///
/// A keypoint between two frames needs both of them: nothing is made up for frames in which it was not seen. It lies on
/// the cubic through four frames (Catmull-Rom), or on the line through two where the outer ones lack it. Its confidence
/// is interpolated, and so are start poses, linearly. Times outside of the view's frames are empty.
void ResampleView(const CaptureObservations& recorded, int clip, int view, const TimeMap& time,
                  CaptureObservations& capture);

/// ResampleView() of all views of a clip; `times` (V).
void ResampleClip(const CaptureObservations& recorded, int clip, const std::vector<TimeMap>& times,
                  CaptureObservations& capture);

}  // namespace canonpose
