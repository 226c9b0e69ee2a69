// Reads lines of words and numbers, as in motion capture files, with messages that name the line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// A text file line by line, each split at blanks; empty lines are skipped. All kinds of line endings are accepted.
class TextLines {
 public:
  /// Text from the character `comment` to the end of its line is ignored; 0 means that there are no comments. Throws
  /// Error(kBadInput).
  explicit TextLines(const std::filesystem::path& path, char comment = 0);

  /// Moves to the next line that has a word; returns false at the end of the file.
  bool Next();

  [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Bytes that remain after this line, which limit any count that the file claims.
  [[nodiscard]] std::size_t bytes_left() const { return text_.size() - position_; }

  /// Parses a text of this line, or its word i, as a finite number of sensible size. Throws Error(kBadInput).
  [[nodiscard]] double ParseNumber(std::string_view text) const;
  [[nodiscard]] double Number(std::size_t i) const { return ParseNumber(words_[i]); }
  /// Parses the words from `begin` on, which must be `count` numbers; `what` says for the message what these are.
  void Numbers(std::size_t begin, std::size_t count, std::string_view what, double* numbers) const;

  /// Throws Error(kBadInput) at this line, with the line's text if `found` is empty.
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

/// A text in quotes, shortened to fit a message, or "bytes that are not text".
std::string Quoted(std::string_view text);

/// A whole number without a sign; -1 where the word is not one or exceeds 2^31 - 1.
long long WholeNumber(std::string_view word);

}  // namespace canonpose
