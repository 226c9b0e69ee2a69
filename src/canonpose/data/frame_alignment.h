// Which frames of several cameras belong together.
#pragma once

#include <vector>

#include "canonpose/data/person_tracking.h"

namespace canonpose {

/// How the frames of several cameras are matched.
enum class FrameAlignment {
  kAutomatic,    ///< by the numbers or times in their names, or in order where these have nothing in common
  kOrder,        ///< the n-th frames of all; all must have as many
  kFrameNumber,  ///< by the numbers or times in their names
  kNone,         ///< not at all: nobody synchronised the cameras (clip_timing.h)
};

/// Gives all clips the same frames; those that a camera lacks are missing in its clip. Logs how, unless all clips have
/// the same frames anyway.
///
/// Frames that count (KeypointClip::seconds_per_number is 0) are matched by equal numbers. kAutomatic does so where at
/// least a quarter of each camera's numbers also exist in another camera; where there are fewer, the cameras count
/// from different numbers, and their frames are matched in order. Numbers that no camera has are missing frames, too,
/// if they are few.
///
/// Frames whose names are times are matched by time, each with the nearest frame of a common clock, so within half a
/// frame interval. Numbers that are not times but are as irregular as those are treated likewise.
///
/// Returns the frame rate that follows from the times; 0 where there are none. Throws Error(kBadInput) where the frames
/// do not match in this way.
double AlignFrames(std::vector<KeypointClip>& clips, FrameAlignment alignment);

/// Whether frames that count can be matched by their numbers; true where they are named by the time.
bool HaveCommonNumbers(const std::vector<KeypointClip>& clips);

/// The frames of one camera that are named by the time get numbers that count frame intervals from 0; others stay as
/// they are. Returns the frame rate; 0 where it is not known.
double CountFrames(KeypointClip& clip);

}  // namespace canonpose
