#include "canonpose/motion/readers/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// No length, angle or time of a body's motion is anywhere near this large.
constexpr double kLargestNumber = 1e9;
constexpr std::size_t kLongestFound = 60;

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

}  // namespace

TextLines::TextLines(const std::filesystem::path& path, char comment)
    : file_(path.string()), text_(ReadFile(path)), comment_(comment) {
  if (text_.starts_with("\xEF\xBB\xBF")) position_ = 3;  // a byte-order mark
}

bool TextLines::Next() {
  words_.clear();
  const std::string_view text = text_;
  while (words_.empty() && position_ < text.size()) {
    ++line_;
    std::size_t end = text.find('\n', position_);
    const std::size_t next = end == std::string_view::npos ? text.size() : end + 1;
    end = std::min(end, text.size());
    for (std::size_t i = position_; i < end;) {
      if (IsBlank(text[i])) {
        ++i;
        continue;
      }
      if (comment_ != 0 && text[i] == comment_) break;
      const std::size_t begin = i;
      while (i < end && !IsBlank(text[i])) ++i;
      words_.push_back(text.substr(begin, i - begin));
    }
    position_ = next;
  }
  return !words_.empty();
}

double TextLines::ParseNumber(std::string_view text) const {
  std::string_view word = text;
  if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  // A number that is too small counts as 0; strtod distinguishes it from one that is too large.
  if (error == std::errc::result_out_of_range) number = std::strtod(std::string(word).c_str(), nullptr);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    Fail("a number", "the file is damaged; export or copy it again", Quoted(text));
  }
  if (!std::isfinite(number)) Fail("a finite number", "the capture failed there; export it again", Quoted(text));
  if (std::abs(number) > kLargestNumber) Fail("a length or an angle", "the file is damaged", Quoted(text));
  return number;
}

void TextLines::Numbers(std::size_t begin, std::size_t count, std::string_view what, double* numbers) const {
  const std::size_t found = words_.size() - std::min(begin, words_.size());
  if (found != count) {
    Fail(fmt::format("{} value{} of {}", count, count == 1 ? "" : "s", what),
         found < count ? "the file was cut off or damaged; export or copy it again" : "",
         fmt::format("{} value{}", found, found == 1 ? "" : "s"));
  }
  for (std::size_t i = 0; i < count; ++i) numbers[i] = Number(begin + i);
}

void TextLines::Fail(const std::string& expected, const std::string& advice, const std::string& found) const {
  std::string text = found;
  if (text.empty() && words_.empty()) text = "the end of the file";
  if (text.empty()) {
    const char* end = words_.back().data() + words_.back().size();
    text = Quoted({words_.front().data(), static_cast<std::size_t>(end - words_.front().data())});
  }
  ThrowBadInput({file_, fmt::format("line {}", line_), expected, text, advice});
}

std::string Quoted(std::string_view text) {
  const bool is_text = std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 0x20 || c == '\t'; });
  if (!is_text) return "bytes that are not text";
  if (text.size() > kLongestFound) return fmt::format("'{}...'", text.substr(0, kLongestFound));
  return fmt::format("'{}'", text);
}

long long WholeNumber(std::string_view word) {
  long long number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool is_whole = error == std::errc() && end == word.data() + word.size();
  return is_whole && number >= 0 && number <= std::numeric_limits<int>::max() ? number : -1;
}

}  // namespace canonpose
