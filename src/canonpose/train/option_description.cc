#include "canonpose/train/option_description.h"

#include <fmt/format.h>

#include "canonpose/train/option_table.h"

namespace canonpose {
namespace {

std::string WithoutBackquotes(std::string text) {
  std::erase(text, '`');
  return text;
}

/// Bars would end a cell.
std::string Cell(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

}  // namespace

std::string Range::ToString() const {
  const bool has_min = std::isfinite(min);
  const bool has_max = std::isfinite(max);
  if (!has_min && !has_max) return "any";
  if (!has_max) return excludes_min ? fmt::format("more than {}", min) : fmt::format("{} or more", min);
  if (!has_min) return fmt::format("at most {}", max);
  return excludes_min ? fmt::format("more than {}, at most {}", min, max) : fmt::format("{} to {}", min, max);
}

std::string OptionDescription::ToText() const {
  std::string text = help;
  if (!meanings.empty()) text += (text.ends_with('.') ? " " : ". ") + meanings;
  const std::string allowed = meanings.empty() && !values.empty() ? values + "; " : "";
  return WithoutBackquotes(text) + fmt::format(" ({}default {})", allowed, default_value);
}

std::string MarkdownTable(const std::vector<OptionDescription>& options) {
  std::string text = "| option | values | default | what it does |\n|---|---|---|---|\n";
  for (const OptionDescription& option : options) {
    std::string help = option.help;
    if (!option.meanings.empty()) help += (help.ends_with('.') ? " " : ". ") + option.meanings;
    if (!option.changes_results)
      help += (help.ends_with('.') ? " " : ". ") + std::string("A resumed run may change it");
    text += fmt::format("| `{}` | {} | {} | {} |\n", option.name, Cell(option.values), Cell(option.default_value),
                        Cell(help));
  }
  return text;
}

}  // namespace canonpose
