// Lines of words and numbers, as motion capture files have them, and messages that name the line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// A text file line by line, each split at blanks; lines without a word are passed over. Any line ending will do.
class TextLines {
 public:
  /// Text from `comment` to the end of its line is left out; 0 for none. Throws Error(kBadInput).
  explicit TextLines(const std::filesystem::path& path, char comment = 0);

  /// Goes to the next line that has a word; false at the end of the file.
  bool Next();

  [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Bytes that are left after this line: no count that a file states can be larger.
  [[nodiscard]] std::size_t bytes_left() const { return text_.size() - position_; }

  /// A text of this line, or its word i, as a finite number of sensible size. Throws Error(kBadInput).
  [[nodiscard]] double ParseNumber(std::string_view text) const;
  [[nodiscard]] double Number(std::size_t i) const { return ParseNumber(words_[i]); }
  /// The words from `begin` on, which must be `count` numbers of `what`.
  void Numbers(std::size_t begin, std::size_t count, std::string_view what, double* numbers) const;

  /// Throws Error(kBadInput) at this line; where `found` is empty, with the line's text.
  [[noreturn]] void Fail(const std::string& expected, const std::string& advice = "",
                         const std::string& found = "") const;

 private:
  std::string file_;
  std::string text_;
  char comment_;
  std::size_t position_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
};

/// In quotes and cut to a length that fits a message; "bytes that are no text" for others.
std::string Quoted(std::string_view text);

/// A whole number without sign; -1 where the word is none or is above 2^31.
long long WholeNumber(std::string_view word);

/// Equal but for upper and lower case of ASCII letters.
bool SameWord(std::string_view a, std::string_view b);

/// Lower case, ASCII.
std::string LowerCase(std::string_view text);

}  // namespace canonpose
