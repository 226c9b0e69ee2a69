// For scripts/tidy only. Clang cannot read LibTorch 1.13's headers as C++20 with GCC 12's library: they hold vectors of
// types that are declared but not yet defined, which a constexpr destructor does not allow. Here std::vector is not
// constexpr.
#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#undef _GLIBCXX20_CONSTEXPR
#define _GLIBCXX20_CONSTEXPR
#define __fill_a1 __fill_a1_of_bits  // declared as constexpr before
#include <vector>
#undef __fill_a1
#undef _GLIBCXX20_CONSTEXPR
#define _GLIBCXX20_CONSTEXPR constexpr
