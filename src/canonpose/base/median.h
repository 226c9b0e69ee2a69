// The median, which a minority of outliers does not affect.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace canonpose {

/// The median; for an even number of values the mean of the middle two, for none NaN.
inline double Median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace canonpose
