#include "canonpose/skeleton/anthropometry.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {

void RequireHeight(double height_m) {
  constexpr double kSmallest = 0.3;
  constexpr double kLargest = 3.0;
  if (height_m >= kSmallest && height_m <= kLargest) return;
  std::string advice;
  for (const auto& [unit, per_metre] : {std::pair("centimetres", 100.0), {"millimetres", 1000.0}}) {
    const double metres = height_m / per_metre;
    if (metres >= kSmallest && metres <= kLargest) advice = fmt::format(" (if these are {}, give {:g})", unit, metres);
  }
  ThrowInvalidArgument("`height`: expected the person's height in metres, such as 1.75, found {:g}{}", height_m,
                       advice);
}

}  // namespace canonpose
