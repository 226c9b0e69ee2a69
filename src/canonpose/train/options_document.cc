#include "canonpose/train/options_document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/train/morph_options.h"
#include "canonpose/train/options.h"

namespace canonpose {
namespace {

std::string PresetTable() {
  std::string text = "| preset | what it is | options that differ from the defaults |\n|---|---|---|\n";
  for (const Preset& preset : Presets()) {
    std::vector<std::string> differences;
    for (const auto& [field, value] : preset.differences) differences.push_back(fmt::format("`{}={}`", field, value));
    text += fmt::format("| `{}` | {} | {} |\n", preset.name, preset.description, fmt::join(differences, ", "));
  }
  return text;
}

}  // namespace

std::string TrainingOptionsDocument() {
  return "# Options of training\n\n"
         "Made from the tables in `src/canonpose/train/options.cc` and `morph_options.cc`; do not edit. After a "
         "change\n"
         "there, write it again: `CANONPOSE_WRITE_DOCS=1 GTEST_FILTER='OptionsDocument.*' build/train_test`.\n\n"
         "## Presets\n\n"
         "`canonpose train` uses `best` unless it is given another one.\n\n" +
         PresetTable() +
         "\n## `canonpose train`\n\n"
         "`canonpose help train` says how an option is set. A resumed run keeps the options it was started with.\n\n" +
         MarkdownTable(DescribeTrainOptions()) + "\n## `canonpose train-morph`\n\n" +
         MarkdownTable(DescribeMorphOptions());
}

}  // namespace canonpose
