// All frames of a capture, solved in windows of time that overlap and share what calibration has found.
#pragma once

#include "canonpose/solve/fit.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Solves every frame: the joints, and the cameras where they move, with bone lengths (and static cameras) as they are.
/// Windows of `window_frames` reach a little into their neighbours, so that a joint near an edge is as smooth as any;
/// they are solved side by side on `threads` threads, each by itself, so that the result does not depend on how many.
/// Memory and time grow with the number of frames.
void SolveWindows(const CaptureObservations& capture, int window_frames, int threads, Solution& solution);

}  // namespace canonpose
