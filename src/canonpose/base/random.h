// Seeded random numbers that are the same on every machine and compiler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <vector>

namespace canonpose {

/// std::mt19937_64, whose output the standard defines, with our own distributions, since the output of the standard's
/// is not defined. A generator is identified by a seed and any number of stream numbers, so that "the permutation of
/// epoch 7" needs no stored state.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::initializer_list<std::uint64_t> stream = {});

  std::uint64_t Bits() { return engine_(); }
  /// Uniform in [0, 1).
  double Uniform();
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Standard normal.
  double Normal();
  /// Uniform in 0 .. count - 1; count > 0.
  std::size_t Index(std::size_t count);
  /// A random order of 0 .. count - 1 (Fisher-Yates).
  std::vector<std::size_t> Permutation(std::size_t count);

 private:
  std::mt19937_64 engine_;
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

}  // namespace canonpose
