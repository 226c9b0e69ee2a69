// Ways to choose some of the frames of a capture.
#pragma once

#include <span>
#include <vector>

namespace canonpose {

/// first .. first + count - 1.
std::vector<int> ConsecutiveFrames(int first, int count);

/// `count` of `frames`, evenly spread, the first included; all of them where there are no more.
std::vector<int> EvenlySpread(std::span<const int> frames, int count);

/// Up to `max_runs` runs of `run_frames` successive elements of `frames`, evenly spread from the first to the last: as
/// many as there is room for, but at least one, which may then be shorter.
std::vector<int> EvenRuns(std::span<const int> frames, int max_runs, int run_frames);

}  // namespace canonpose
