// Numbers with a decimal comma, which no option takes.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace canonpose {

/// "; write 1.75, with a point" for "1,75"; empty for any other text.
inline std::string HintAtDecimalComma(const std::string& text) {
  const std::size_t comma = text.find(',');
  const std::size_t first = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  const auto are_digits = [&](std::size_t begin, std::size_t end) {
    return begin < end && std::all_of(text.begin() + static_cast<std::ptrdiff_t>(begin),
                                      text.begin() + static_cast<std::ptrdiff_t>(end),
                                      [](unsigned char c) { return std::isdigit(c) != 0; });
  };
  if (comma == std::string::npos || !are_digits(first, comma) || !are_digits(comma + 1, text.size())) return "";
  std::string number = text;
  number[comma] = '.';
  return "; write " + number + ", with a point";
}

}  // namespace canonpose
