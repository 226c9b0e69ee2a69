// The command line before and after CLI11: words such as `help` that stand for options, and messages about mistakes.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace canonpose {

/// Adds the commands `help` and `version` to the list of commands; but for `version --json`, which describes the
/// machine for bug reports and tests, WithoutHelpWords() does their work.
void AddHelpCommands(CLI::App& app);

/// "help", "help COMMAND" and "version" by itself as the options that do the same.
std::vector<std::string> WithoutHelpWords(const std::vector<std::string>& arguments);

/// Throws Error(kInvalidArgument) if the first of `arguments` is not a command, or there is none.
void RequireCommand(const CLI::App& app, const std::vector<std::string>& arguments);

/// What is wrong with the command line, in one line. An unknown option comes before what `error` says, which is often
/// its consequence.
std::string DescribeMistake(const CLI::App& app, const CLI::ParseError& error);

}  // namespace canonpose
