// Several short runs from different seeds, of which the best is gone on with: view mixing alone may settle in a trap,
// and its loss shows that, if faintly, before the end.
#pragma once

#include <cstdint>
#include <vector>

namespace canonpose {

/// The seed of a short run: for the first the whole run's own. What is gone on with is the run of its seed alone, bit
/// for bit.
std::uint64_t RestartSeed(std::uint64_t seed, int restart);

/// The number of the least loss, the first of equals; there is at least one.
int BestRestart(const std::vector<double>& losses);

}  // namespace canonpose
