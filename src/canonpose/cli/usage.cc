#include "canonpose/cli/usage.h"

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/decimal_comma.h"
#include "canonpose/base/error.h"
#include "canonpose/base/nearest_name.h"
#include "canonpose/base/version.h"
#include "canonpose/cli/with_torch.h"

namespace canonpose {
namespace {

bool IsOption(const std::string& argument) { return argument.starts_with('-'); }

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// Without their dashes.
std::vector<std::string> OptionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    const std::vector<std::string>& long_names = option->get_lnames();
    names.insert(names.end(), long_names.begin(), long_names.end());
  }
  return names;
}

/// The first argument that looks like an option but is not one.
std::optional<std::string> UnknownOption(const CLI::App& command) {
  const std::vector<std::string> left = command.remaining();
  const auto found = std::find_if(left.begin(), left.end(), IsOption);
  if (found == left.end()) return std::nullopt;
  return found->substr(0, found->find('='));
}

/// The command that was given, or the program itself.
const CLI::App& Given(const CLI::App& app) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  return commands.empty() ? app : *commands.front();
}

/// For "Could not convert: --height = 1,75".
std::string HintAtValue(const CLI::ParseError& error) {
  const std::string what = error.what();
  const std::size_t space = what.find_last_of(' ');
  return space == std::string::npos ? "" : HintAtDecimalComma(what.substr(space + 1));
}

nlohmann::json DescribeProgram() {
  return {{"version", ProgramVersion()}, {"linear_algebra", nlohmann::json::parse(DescribeLinearAlgebra())}};
}

std::string HelpOf(const CLI::App& app, const CLI::App& command) {
  return &command == &app ? "canonpose help" : fmt::format("canonpose help {}", command.get_name());
}

}  // namespace

void AddHelpCommands(CLI::App& app) {
  auto command = std::make_shared<std::string>();
  app.add_subcommand("help", "List the commands, or show all options of one")
      ->add_option("command", *command, "The command to show");
  CLI::App* version = app.add_subcommand("version", "Print the program's version");
  auto json = std::make_shared<bool>(false);
  version->add_flag("--json", *json, "As JSON, with the linear algebra library in use and its speed");
  version->callback([json] {
    if (*json) fmt::print("{}\n", DescribeProgram().dump(2));
  });
}

std::vector<std::string> WithoutHelpWords(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return arguments;
  if (arguments == std::vector<std::string>{"version"}) return {"--version"};
  if (arguments.front() != "help") return arguments;
  std::vector<std::string> options(arguments.begin() + 1, arguments.end());
  options.emplace_back("--help");
  return options;
}

void RequireCommand(const CLI::App& app, const std::vector<std::string>& arguments) {
  const std::vector<std::string> names = CommandNames(app);
  if (arguments.empty()) {
    ThrowInvalidArgument("a command is missing; the commands are {} (canonpose help describes them)",
                         fmt::join(names, ", "));
  }
  const std::string& word = arguments.front();
  if (IsOption(word) || std::find(names.begin(), names.end(), word) != names.end()) return;
  if (const std::optional<std::string> nearest = NearestName(word, names)) {
    ThrowInvalidArgument("there is no command \"{}\"; did you mean {}? (canonpose help lists them)", word, *nearest);
  }
  ThrowInvalidArgument("there is no command \"{}\"; the commands are {} (canonpose help describes them)", word,
                       fmt::join(names, ", "));
}

std::string DescribeMistake(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = Given(app);
  const std::string help = HelpOf(app, command);
  const std::optional<std::string> unknown = UnknownOption(command);
  if (!unknown) return fmt::format("{}{} (see {})", error.what(), HintAtValue(error), help);
  const std::string word = unknown->substr(std::min(unknown->find_first_not_of('-'), unknown->size()));
  const std::optional<std::string> nearest = NearestName(word, OptionNames(command));
  return fmt::format("{} has no option {}{} (see {})", command.get_name(), *unknown,
                     nearest ? fmt::format("; did you mean --{}?", *nearest) : "", help);
}

}  // namespace canonpose
