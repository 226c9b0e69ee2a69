#include "canonpose/cli/option_names.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace canonpose {
namespace {

bool HasOption(const CLI::App& command, const std::string& option) {
  return command.get_option_no_throw(option) != nullptr;
}

/// The option that sets a field, with its value if there is one.
std::optional<std::string> OptionOf(const std::string& field, const std::string& value, const CLI::App& app,
                                    const std::function<bool(const std::string&)>& is_training_option) {
  std::string option = "--" + field;
  std::replace(option.begin(), option.end(), '_', '-');
  const std::string with_value = value.empty() ? option : option + " " + value;
  const std::vector<CLI::App*> given = app.get_subcommands();
  if (!given.empty() && HasOption(*given.front(), option)) return with_value;
  const auto all = [](const CLI::App*) { return true; };
  const auto commands = app.get_subcommands(all);
  const auto has_it = [&](const CLI::App* command) { return HasOption(*command, option); };
  if (std::ranges::any_of(commands,
                          [&](const CLI::App* command) { return command->get_name() == "train" && has_it(command); })) {
    return with_value;
  }
  if (is_training_option(field)) return "--set " + (value.empty() ? field : field + "=" + value);
  return std::ranges::any_of(commands, has_it) ? std::optional(with_value) : std::nullopt;
}

}  // namespace

std::string SpellOptions(const std::string& message, const CLI::App& app,
                         const std::function<bool(const std::string&)>& is_training_option) {
  std::string spelled;
  std::size_t begin = 0;
  while (true) {
    const std::size_t open = message.find('`', begin);
    const std::size_t close = open == std::string::npos ? open : message.find('`', open + 1);
    if (close == std::string::npos) return spelled + message.substr(begin);
    const std::string word = message.substr(open + 1, close - open - 1);
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string value = equals < word.size() ? word.substr(equals + 1) : "";
    spelled += message.substr(begin, open - begin);
    spelled += OptionOf(word.substr(0, equals), value, app, is_training_option).value_or("`" + word + "`");
    begin = close + 1;
  }
}

}  // namespace canonpose
