#include "canonpose/cli/shell_line.h"

#include <algorithm>

namespace canonpose {
namespace {

bool IsHarmless(unsigned char c) {
  constexpr std::string_view kSigns = "-_./=:,+@%";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         kSigns.find(static_cast<char>(c)) != std::string_view::npos;
}

std::string Quote(const std::string& word) {
  if (!word.empty() && std::ranges::all_of(word, IsHarmless)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string OptionFor(const std::string& field) {
  if (field == "output") return "-o";
  std::string option = "--" + field;
  std::ranges::replace(option, '_', '-');
  return option;
}

std::vector<std::string> CommandLineOf(const ResolvedCommand& command) {
  std::vector<std::string> words{command.name};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  for (const auto& [field, value] : command.fields) {
    words.push_back(OptionFor(field));
    if (!value.empty()) words.push_back(value);
  }
  return words;
}

std::string ShellLine(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + Quote(word);
  return line;
}

}  // namespace canonpose
