// What the names of a camera's files or images say about when its frames were taken.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// The last number in a name without its extension: "cam01.0012.json" -> 12. Null if there is none.
std::optional<std::int64_t> LastNumber(std::string_view file_name);

/// The numbers of a camera's frames.
struct FrameNumbers {
  std::vector<std::int64_t> numbers;  ///< one per name, in the order of the names
  /// Where the names are times, the numbers are multiples of this; 0 where they count frames.
  double seconds_per_number = 0.0;
};

/// The numbers of frames with these names, each of which must contain a number. Usually that is the last one of each
/// name. Where all names are times, the number is the time: seconds with a decimal point ("1714564803.200403"),
/// milli-, micro- or nanoseconds since 1970 ("1714564803200"), or a time of day with a fraction of a second, with or
/// without a date ("2024-05-01_12-00-03.200", "20240501_120003_200403"). Names count as times only if they all differ
/// and, put in order, are between 1.9 milliseconds and 10 seconds apart (in the median); so a date and a counter
/// ("20240501_120003_000012") is a counter. Where the last number is the same in all names, another one that differs
/// in all of them is taken ("0012_cam1").
FrameNumbers NumberFrames(const std::vector<std::string>& names);

}  // namespace canonpose
