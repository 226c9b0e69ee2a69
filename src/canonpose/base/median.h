// The median, which a minority of bad values does not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace canonpose {

/// Of an even number the mean of the two in the middle; NaN of nothing.
inline double Median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace canonpose
