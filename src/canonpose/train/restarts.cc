#include "canonpose/train/restarts.h"

#include <algorithm>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"

namespace canonpose {
namespace {

/// Apart from the streams that training itself draws from.
constexpr std::uint64_t kRestartStream = 101;

}  // namespace

std::uint64_t RestartSeed(std::uint64_t seed, int restart) {
  if (restart == 0) return seed;
  return Rng(seed, {kRestartStream, static_cast<std::uint64_t>(restart)}).Bits();
}

int BestRestart(const std::vector<double>& losses) {
  CANONPOSE_CHECK(!losses.empty());
  return static_cast<int>(std::min_element(losses.begin(), losses.end()) - losses.begin());
}

}  // namespace canonpose
