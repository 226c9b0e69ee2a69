// What is done about frames that cameras lost in the middle of a clip, and where they were found too early.
#pragma once

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Takes the frames behind those that a static view lost at the others' time, in the clip and view where that gains
/// most. Returns whether any were lost.
bool CorrectTimeJump(const CaptureObservations& original, CaptureObservations& capture, const Solution& solution,
                     CameraCheck& check);

/// Forgets jumps in time that were found before a view of the same clip turned out to have another frame rate: against
/// such a view the others seem to jump. Returns whether there were any.
bool ForgetTimeJumps(const CaptureObservations& original, CaptureObservations& capture, CameraCheck& check);

}  // namespace canonpose
