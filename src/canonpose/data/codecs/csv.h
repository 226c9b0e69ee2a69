// Tables of text: comma-separated values as spreadsheets, pandas and hand-written scripts write them.
//
// For readers only.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// The rows of a file; each keeps the line it began at.
struct CsvRow {
  long line = 0;  ///< from 1
  std::vector<std::string> cells;
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line); }
};

/// Cells are separated by commas, or by semicolons or tabs where the first line has those and no comma. A cell in
/// double quotes may contain separators, line breaks and quotes ("" for one). White space around cells is taken off,
/// and so is a byte order mark. Empty lines are left out. Throws Error(kBadInput) where the file cannot be read, is not
/// text, or has no row.
std::vector<CsvRow> ReadCsv(const std::filesystem::path& path);

/// A cell as a number: NaN where it is empty, or "nan", "NA", "null" or "None" in any case. Throws Error(kBadInput)
/// that names the row and the column where it is another text, infinite, or larger than any coordinate.
double CsvNumber(const CsvRow& row, std::size_t column, const std::string& file);

/// Whether a cell is a number or one of the texts above.
bool IsCsvNumber(std::string_view cell);

}  // namespace canonpose
