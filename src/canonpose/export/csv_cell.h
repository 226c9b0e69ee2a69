// Cells of CSV files.
#pragma once

#include <string>

namespace canonpose {

/// A cell as in RFC 4180: quoted if it contains a separator.
inline std::string CsvCell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace canonpose
