// The median, which a minority of bad values does not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace canonpose {

/// The upper median; NaN of nothing.
inline double Median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace canonpose
