// Choosing some of a capture's frames.
#pragma once

#include <span>
#include <vector>

namespace canonpose {

/// first .. first + count - 1.
std::vector<int> ConsecutiveFrames(int first, int count);

/// `count` of `frames`, evenly spread over them, the first included; all where there are no more.
std::vector<int> EvenlySpread(std::span<const int> frames, int count);

/// Up to `most_runs` runs of `run_frames` frames that follow each other in `frames`, evenly spread from the first to
/// the last: as many runs as there is room for, one at least, which may be shorter.
std::vector<int> EvenRuns(std::span<const int> frames, int most_runs, int run_frames);

}  // namespace canonpose
