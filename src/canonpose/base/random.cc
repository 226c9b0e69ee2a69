#include "canonpose/base/random.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "canonpose/base/error.h"

namespace canonpose {

Rng::Rng(std::uint64_t seed, std::initializer_list<std::uint64_t> stream) {
  std::vector<std::uint32_t> words;
  const auto append = [&words](std::uint64_t word) {
    words.push_back(static_cast<std::uint32_t>(word));
    words.push_back(static_cast<std::uint32_t>(word >> 32));
  };
  append(seed);
  for (const std::uint64_t word : stream) append(word);
  std::seed_seq sequence(words.begin(), words.end());
  engine_.seed(sequence);
}

double Rng::Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

double Rng::Normal() {
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  // Box-Muller; 1 - u lies in (0, 1], so the logarithm is finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
  const double angle = 2.0 * std::numbers::pi * Uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_normal_ = true;
  return radius * std::cos(angle);
}

std::size_t Rng::Index(std::size_t count) {
  CANONPOSE_CHECK(count > 0, "count {}", count);
  // Rejection keeps every index equally likely.
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % count;
  std::uint64_t bits = engine_();
  while (bits >= limit) bits = engine_();
  return static_cast<std::size_t>(bits % count);
}

std::vector<std::size_t> Rng::Permutation(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[Index(i)]);
  return order;
}

}  // namespace canonpose
