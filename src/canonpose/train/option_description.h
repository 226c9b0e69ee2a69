// What an option is, as text: for help and documentation.
#pragma once

#include <string>
#include <vector>

namespace canonpose {

struct OptionDescription {
  std::string name;           ///< of the field: "camera_weight"
  std::string values;         ///< "off, static, window", "1 or more"
  std::string default_value;  ///< "1024", or "1024; 256 for best and plus"
  std::string help;           ///< without the meanings of its values; names of fields in backquotes
  std::string meanings;       ///< "off: ...; static: ..."; may be empty
  bool changes_results = true;

  /// All but the name in one paragraph of plain text: "Width of the network's layers (1 to 65536; default 1024)"
  [[nodiscard]] std::string ToText() const;
};

/// A table of options in Markdown.
std::string MarkdownTable(const std::vector<OptionDescription>& options);

}  // namespace canonpose
