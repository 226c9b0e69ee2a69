// Keypoints that show nothing: a detector that always writes all joints invents those that it does not see, and says so
// only by a low confidence.
//
// Robust losses deal with a few wrong keypoints, and the noise model with inexact ones. An arm that is invented in half
// of the views throughout is neither: it has as many keypoints as the true one, and they pull.
#pragma once

#include <span>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Removes, for each view and joint, the keypoints of low confidence (up to half of the capture's median) if most
/// of them are nowhere near the joint that the solution shows: those up to the confidence that separates near and far
/// best. They then count as not detected. `frames` (ascending) are those in which the solution is judged; keypoints are
/// removed in all frames. Returns how many.
int RemoveInvented(std::span<const int> frames, const Solution& solution, CaptureObservations& capture);

}  // namespace canonpose
