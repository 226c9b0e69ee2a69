// Left and right exchanged by the detector in one view for some frames: found by what the other views and the
// neighbouring frames say, and mended.
//
// For each part of the body and each frame, every pattern of exchanged views (none, one, two of them) is tried: the
// part's joints are triangulated as if those views had left and right the wrong way round, and cost what they are off
// the keypoints, off the lengths of bones, and from where they were in the frame before. Exchanges cost something, too,
// and so do changes of the pattern: they must explain that much. The cheapest path through the frames is taken.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// The joints that detectors exchange together, as pairs of left-right partners.
struct SwapParts {
  using Pairs = std::vector<std::array<int, 2>>;
  Pairs legs;  ///< hips and what is below them
  Pairs arms;  ///< shoulders and what is below them, the legs apart
  Pairs rest;  ///< of the head, say
};

/// From the partners and the tree of a skeleton; hips and shoulders are known by name.
SwapParts FindSwapParts(const Skeleton& skeleton);

/// The state 0 .. states - 1 of each frame whose costs add up to the least (Viterbi): cost(frame, state) and, from the
/// second frame on, change(frame, state before, state).
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

/// Exchanges left and right keypoints (legs, arms, or all) in `capture` where that explains them clearly better, and
/// returns in how many frames of how many views (their sum) it did. Needs cameras and bone lengths; joints are
/// triangulated anew. The lifter's pose of a view whose legs and arms were both exchanged is removed. The result does
/// not depend on `threads`.
int MendSwaps(CaptureObservations& capture, const Solution& solution, int threads);

}  // namespace canonpose
