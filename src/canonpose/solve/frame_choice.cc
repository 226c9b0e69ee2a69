#include "canonpose/solve/frame_choice.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace canonpose {

std::vector<int> ConsecutiveFrames(int first, int count) {
  std::vector<int> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), first);
  return frames;
}

std::vector<int> EvenlySpread(std::span<const int> frames, int count) {
  const auto chosen_count = std::min(frames.size(), static_cast<std::size_t>(count));
  std::vector<int> chosen;
  for (std::size_t i = 0; i < chosen_count; ++i) chosen.push_back(frames[i * frames.size() / chosen_count]);
  return chosen;
}

std::vector<int> EvenRuns(std::span<const int> frames, int max_runs, int run_frames) {
  const auto count = static_cast<int>(frames.size());
  const int runs = std::clamp(count / run_frames, 1, max_runs);
  std::vector<int> chosen;
  for (int r = 0; r < runs; ++r) {
    const int first = runs == 1 ? 0 : r * (count - run_frames) / (runs - 1);
    const int last = std::min(count, first + run_frames);
    chosen.insert(chosen.end(), frames.begin() + first, frames.begin() + last);
  }
  return chosen;
}

}  // namespace canonpose
