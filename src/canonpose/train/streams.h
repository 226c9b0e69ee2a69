// The first stream number of each random generator of training (base/random.h): what it draws numbers for.
#pragma once

#include <cstdint>

namespace canonpose::stream {

inline constexpr std::uint64_t kInitialisation = 1;
inline constexpr std::uint64_t kFrameOrder = 2;      ///< and the epoch
inline constexpr std::uint64_t kPermutations = 3;    ///< and the step
inline constexpr std::uint64_t kAugmentation = 4;    ///< and the step
inline constexpr std::uint64_t kDropout = 5;         ///< and the step
inline constexpr std::uint64_t kRestartSeeds = 101;  ///< and the restart

}  // namespace canonpose::stream
