#include "canonpose/cli/field_options.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

constexpr std::size_t kLineWidth = 110;
constexpr std::size_t kMaxNameWidth = 26;

/// The words of a text, in lines of at most `width` characters.
std::vector<std::string> Wrap(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (line.size() + 1 + word.size() <= width) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace

void AddFieldOptions(CLI::App& command, const std::vector<OptionDescription>& options,
                     const std::vector<std::string>& names,
                     const std::function<void(const std::string& name, const std::string& value)>& set) {
  for (const std::string& name : names) {
    const auto option = std::ranges::find(options, name, &OptionDescription::name);
    CANONPOSE_CHECK(option != options.end(), "{}", name);
    std::string spelled = "--" + name;
    std::ranges::replace(spelled, '_', '-');
    command
        .add_option_function<std::string>(
            spelled, [set, name](const std::string& value) { set(name, value); }, option->ToText())
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->type_name("VALUE");
  }
}

std::string ListOptions(const std::vector<OptionDescription>& options) {
  std::vector<std::pair<std::string, std::string>> paragraphs;
  for (const OptionDescription& option : options) paragraphs.emplace_back(option.name, option.ToText());
  return ListInColumns(paragraphs);
}

std::string ListInColumns(const std::vector<std::pair<std::string, std::string>>& paragraphs) {
  std::string text;
  for (const auto& [name, paragraph] : paragraphs) {
    std::string before = name;
    for (const std::string& line : Wrap(paragraph, kLineWidth - kMaxNameWidth - 2)) {
      text += fmt::format("  {:<{}}{}\n", before, kMaxNameWidth, line);
      before.clear();
    }
  }
  return text;
}

}  // namespace canonpose
