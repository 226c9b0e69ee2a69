// Left-right swaps: frames in which the detector took left for right in a view. They are found by comparison with the
// other views and the neighbouring frames, and corrected.
//
// For each part of the body and each frame, all sets of up to two swapped views are tried. The part's joints are
// triangulated as if those views had left and right exchanged. The cost is what the joints are off the keypoints, off
// the bone lengths, and away from where they were in the frame before. Swapped views and changes from frame to frame
// cost extra, so that a swap must explain the keypoints clearly better. The cheapest path through the frames wins.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// The joints that detectors swap together, as pairs of left-right partners.
struct SwapParts {
  using Pairs = std::vector<std::array<int, 2>>;
  Pairs legs;  ///< hips and what is below them in the tree
  Pairs arms;  ///< shoulders and what is below them, without legs
  Pairs rest;  ///< all others, such as eyes and ears
};

/// From the partners and the tree of a skeleton; hips and shoulders are recognised by name.
SwapParts FindSwapParts(const Skeleton& skeleton);

/// The path of states (0 .. states - 1, one per frame) of least total cost, by Viterbi's algorithm. The total is the
/// sum of cost(frame, state) and, from the second frame on, change(frame, state before, state).
template <typename Cost, typename Change>
std::vector<int> CheapestPath(int frames, int states, Cost&& cost, Change&& change) {
  const auto width = static_cast<std::size_t>(states);
  std::vector<double> total(width);
  std::vector<int> from(static_cast<std::size_t>(frames) * width, 0);
  for (int n = 0; n < frames; ++n) {
    std::vector<double> now(width);
    for (int s = 0; s < states; ++s) {
      double least = n == 0 ? 0.0 : std::numeric_limits<double>::infinity();
      for (int before = 0; n > 0 && before < states; ++before) {
        const double sum = total[static_cast<std::size_t>(before)] + change(n, before, s);
        if (sum >= least) continue;
        least = sum;
        from[static_cast<std::size_t>(n) * width + static_cast<std::size_t>(s)] = before;
      }
      now[static_cast<std::size_t>(s)] = least + cost(n, s);
    }
    total = std::move(now);
  }
  std::vector<int> path(static_cast<std::size_t>(frames));
  if (frames == 0) return path;
  path.back() = static_cast<int>(std::min_element(total.begin(), total.end()) - total.begin());
  for (std::size_t n = path.size() - 1; n > 0; --n) {
    path[n - 1] = from[n * width + static_cast<std::size_t>(path[n])];
  }
  return path;
}

/// Exchanges left and right keypoints (of legs, arms, the rest) in `capture` where that explains them clearly better.
/// Returns the number of frames in which it did, summed over views. Needs cameras and bone lengths; joints are
/// triangulated anew. Removes the start pose of a view whose legs and arms were both swapped. The result does not
/// depend on `threads`.
int CorrectSwaps(CaptureObservations& capture, const Solution& solution, int threads);

}  // namespace canonpose
