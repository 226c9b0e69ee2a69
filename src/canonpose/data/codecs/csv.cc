#include "canonpose/data/codecs/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/file_kind.h"

namespace canonpose {
namespace {

/// No pixel coordinate is anywhere near this large.
constexpr double kLargestCellValue = 1e9;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlank = " \t\r";

std::string_view WithoutBlanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return "";
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

char SeparatorOf(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

/// Takes rows from a text, one after the other.
class Splitter {
 public:
  Splitter(std::string_view text, const std::string& file) : text_(text), file_(file), separator_(SeparatorOf(text)) {}

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }

  CsvRow Next() {
    CsvRow row;
    row.line = line_;
    bool is_end_of_row = false;
    while (!is_end_of_row) row.cells.push_back(NextCell(&is_end_of_row));
    return row;
  }

 private:
  /// The cell at the position, which moves behind it and what ends it.
  std::string NextCell(bool* is_end_of_row) {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\r')) ++at_;
    std::string cell;
    if (at_ < text_.size() && text_[at_] == '"') cell = Quoted();
    const std::size_t end = std::min(text_.find(separator_, at_), text_.find('\n', at_));
    const std::string_view rest = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    cell += WithoutBlanks(rest);
    at_ = end == std::string_view::npos ? text_.size() : end;
    *is_end_of_row = at_ >= text_.size() || text_[at_] == '\n';
    if (at_ < text_.size() && text_[at_] == '\n') ++line_;
    ++at_;
    return cell;
  }

  std::string Quoted() {
    const long line = line_;
    std::string cell;
    for (++at_; at_ < text_.size(); ++at_) {
      const bool is_quote = text_[at_] == '"';
      if (is_quote && (at_ + 1 == text_.size() || text_[at_ + 1] != '"')) {
        ++at_;
        return cell;
      }
      if (is_quote) ++at_;
      line_ += text_[at_] == '\n' ? 1 : 0;
      cell += text_[at_];
    }
    ThrowBadInput({file_, fmt::format("line {}", line), "the end of a text in quotes", "the end of the file",
                   "the file is cut short; export it again"});
  }

  std::string_view text_;
  const std::string& file_;
  char separator_;
  std::size_t at_ = 0;
  long line_ = 1;
};

/// Nothing where the cell is no number.
std::optional<double> ParseNumber(std::string_view cell) {
  static constexpr std::array<std::string_view, 6> kMissing{"", "nan", "na", "null", "none", "-nan"};
  const bool is_missing =
      std::any_of(kMissing.begin(), kMissing.end(), [&](std::string_view missing) { return SameName(cell, missing); });
  if (is_missing) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (end != cell.data() + cell.size()) return std::nullopt;
  // Too small for a double is zero.
  if (error == std::errc::result_out_of_range) return cell.find("e-") != std::string_view::npos ? 0.0 : HUGE_VAL;
  if (error != std::errc()) return std::nullopt;
  return value;
}

}  // namespace

std::vector<CsvRow> ReadCsv(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string kind = KindOfFile(path);
  if (!kind.empty()) ThrowBadInput({file, "", "a table of text (csv)", kind, AdviceForKind(kind)});
  const std::string content = ReadFile(path);
  std::string_view text = content;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.find('\0') != std::string_view::npos) {
    ThrowBadInput({file, "", "a table of text (csv)", "bytes that are no text", "export it again as UTF-8"});
  }
  std::vector<CsvRow> rows;
  for (Splitter splitter(text, file); !splitter.at_end();) {
    CsvRow row = splitter.Next();
    const bool is_empty =
        std::all_of(row.cells.begin(), row.cells.end(), [](const auto& cell) { return cell.empty(); });
    if (!is_empty) rows.push_back(std::move(row));
  }
  if (rows.empty()) ThrowBadInput({file, "", "a table of text (csv)", "an empty file", "export it again"});
  return rows;
}

double CsvNumber(const CsvRow& row, std::size_t column, const std::string& file) {
  const auto place = [&] { return fmt::format("{}, column {}", row.place(), column + 1); };
  if (column >= row.cells.size()) {
    ThrowBadInput({file, place(), "a number", fmt::format("a row of {} cells", row.cells.size()),
                   "the row is cut short; export the file again"});
  }
  const std::string& cell = row.cells[column];
  const std::optional<double> value = ParseNumber(cell);
  if (!value) {
    ThrowBadInput({file, place(), "a number", "\"" + cell.substr(0, 40) + "\"", "correct it, or leave the cell empty"});
  }
  if (std::abs(*value) > kLargestCellValue) {
    ThrowBadInput({file, place(), "a coordinate or a confidence", cell.substr(0, 40), "leave missing values empty"});
  }
  return *value;
}

bool IsCsvNumber(std::string_view cell) { return ParseNumber(cell).has_value(); }

}  // namespace canonpose
