// Arrays with one row per frame.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace canonpose {

/// Keeps rows first, first + step, ... before `end` of an array with one row per frame. An empty array stays empty.
template <typename T>
void KeepRows(std::vector<T>& values, int frame_count, int first, int end, int step) {
  if (values.empty()) return;
  const auto row = static_cast<std::ptrdiff_t>(values.size()) / frame_count;
  std::vector<T> kept;
  for (int frame = first; frame < end; frame += step) {
    const auto begin = values.begin() + row * frame;
    kept.insert(kept.end(), begin, begin + row);
  }
  values = std::move(kept);
}

}  // namespace canonpose
