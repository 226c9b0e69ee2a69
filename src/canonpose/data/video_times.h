// Frames of videos are matched by their time stamps rather than by counting them.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/video_facts.h"

namespace canonpose {

/// Numbers the frames of clips from videos by their time stamps. Where all videos have one constant rate, frames count
/// its intervals from each video's first frame, so that a damaged frame leaves a gap; the rate is returned. Otherwise
/// numbers become times in microseconds (KeypointClip::seconds_per_number), which AlignFrames() matches, and 0 is
/// returned. Clips stay as they are, and the result is 0, unless all of them have facts with a time for every frame.
double NumberByVideoTimes(std::vector<KeypointClip>& clips, const std::vector<std::optional<VideoFacts>>& facts);

/// The rate of all videos; 0 where it is not known of all, or they differ.
double CommonRate(const std::vector<std::optional<VideoFacts>>& facts);

}  // namespace canonpose
