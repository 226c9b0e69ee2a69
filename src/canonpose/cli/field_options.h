// Command-line options that set fields of an options struct, made from the table of its fields.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "canonpose/train/option_description.h"

namespace canonpose {

/// Adds --batch-poses for the field batch_poses, and so on, for the fields `names` of `options`. `set` is called with
/// the name of the field and the text that was given; the last one counts where an option is given several times.
void AddFieldOptions(CLI::App& command, const std::vector<OptionDescription>& options,
                     const std::vector<std::string>& names,
                     const std::function<void(const std::string& name, const std::string& value)>& set);

/// "name  help" for each option, for a footer; lines are wrapped.
std::string ListOptions(const std::vector<OptionDescription>& options);

/// Paragraphs with a name in front of each, in two columns; lines are wrapped.
std::string ListInColumns(const std::vector<std::pair<std::string, std::string>>& paragraphs);

}  // namespace canonpose
