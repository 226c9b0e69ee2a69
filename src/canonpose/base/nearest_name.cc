#include "canonpose/base/nearest_name.h"

#include <algorithm>

#include "canonpose/base/names.h"

namespace canonpose {
namespace {

/// A shorter prefix may mean any name.
constexpr std::size_t kMinBeginning = 3;
constexpr std::size_t kLettersPerSlip = 3;

/// Letters missed, added, replaced or swapped: the optimal string alignment distance.
std::size_t Slips(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> slips(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        slips[i][j] = i + j;
        continue;
      }
      const std::size_t exchanged = a[i - 1] == b[j - 1] ? 0 : 1;
      slips[i][j] = std::min({slips[i - 1][j] + 1, slips[i][j - 1] + 1, slips[i - 1][j - 1] + exchanged});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        slips[i][j] = std::min(slips[i][j], slips[i - 2][j - 2] + 1);
      }
    }
  }
  return slips[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> NearestName(std::string_view word, const std::vector<std::string>& names) {
  const std::string typed = LowerCase(word);
  const auto begins = [&](const std::string& name) { return LowerCase(name).starts_with(typed); };
  if (typed.size() >= kMinBeginning && std::count_if(names.begin(), names.end(), begins) == 1) {
    return *std::find_if(names.begin(), names.end(), begins);
  }
  std::optional<std::string> nearest;
  std::size_t fewest = std::max<std::size_t>(1, typed.size() / kLettersPerSlip) + 1;
  for (const std::string& name : names) {
    const std::size_t slips = Slips(typed, LowerCase(name));
    if (slips >= fewest || slips >= name.size()) continue;
    fewest = slips;
    nearest = name;
  }
  return nearest;
}

}  // namespace canonpose
