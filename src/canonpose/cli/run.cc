// canonpose run VIDEO|FOLDER... -o OUT
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/cli/run_closing.h"
#include "canonpose/cli/shell_line.h"
#include "canonpose/cli/usage.h"
#include "canonpose/cli/with_torch.h"
#include "canonpose/export/scene_formats.h"
#include "canonpose/pipeline/run_recording.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// The path of `canonpose`, which works in any folder. It may have become the program with the networks (with_torch.h).
std::string ProgramPath() {
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& folder : PlacesOfProgram(path.parent_path())) {
    const fs::path program = (folder / "canonpose").lexically_normal();
    if (!error && fs::is_regular_file(program, error)) return program.string();
  }
  return "canonpose";
}

/// A command by itself, in this process.
void Parse(CLI::App& app, const ResolvedCommand& command) {
  std::vector<std::string> words = CommandLineOf(command);
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::RuntimeError&) {  // a signal stopped the command, which has saved its state
    throw Error(ErrorKind::kStopped, "stopped");
  } catch (const CLI::ParseError& error) {
    ThrowInvalidArgument("{}", DescribeMistake(app, error));
  }
}

/// What commands say about what to do after them is not for those whose next command runs by itself.
Callbacks WithoutAdviceOnNext() {
  Callbacks callbacks = PassOn();
  callbacks.message = [message = callbacks.message](MessageLevel level, const std::string& text) {
    if (text.starts_with("next: ") || text.starts_with("stopped and saved")) return;
    if (message) message(level, text);
  };
  return callbacks;
}

void ExecuteCommand(const ResolvedCommand& command) {
  CLI::App app;
  AddCommandsOfSteps(app);
  const CallbackScope callbacks(WithoutAdviceOnNext());
  Parse(app, command);
}

/// Thrown when a command line is parsed and found to be right, before the command is executed.
struct IsParsed {};

void CheckCommand(const ResolvedCommand& command) {
  CLI::App app;
  AddCommandsOfSteps(app);
  // The command's own callback stays: what the options are parsed into lives in it.
  app.get_subcommand(command.name)->parse_complete_callback([] { throw IsParsed(); });
  try {
    Parse(app, command);
  } catch (const IsParsed&) {  // as it should be
  }
  if (command.name == "train") CheckTrainingOptions(command.fields);
}

void RunRun(const RunOptions& options) {
  const std::string program = ProgramPath();
  const auto spell = [&](const ResolvedCommand& command) {
    std::vector<std::string> words = CommandLineOf(command);
    words.insert(words.begin(), program);
    return ShellLine(words);
  };
  const StopOnSignal stop_on_signal;
  try {
    const RunReport report = RunRecording(options, {ExecuteCommand, CheckCommand, spell});
    std::cout << ClosingLines(report, program, options.output, options.Get("height")) << std::flush;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kStopped) throw;
    LogInfo("stopped; to continue, run the same command again");
    throw CLI::RuntimeError(StopOnSignal::exit_code());
  }
}

/// Adds an option of another command as it is there.
void AddOptionOf(const CLI::App& other, const CLI::Option& option, const std::string& field, CLI::App& command,
                 const std::shared_ptr<RunOptions>& options) {
  const std::string group = fmt::format("Options of {}", other.get_name());
  if (option.get_items_expected_max() == 0) {
    command
        .add_flag_function(
            OptionFor(field), [options, field](std::int64_t) { options->fields.emplace_back(field, ""); },
            option.get_description())
        ->group(group);
    return;
  }
  const auto add = [options, field](const std::vector<std::string>& values) {
    for (const std::string& value : values) {
      if (value.empty()) ThrowInvalidArgument("{}: expected a value, found nothing", OptionFor(field));
      options->fields.emplace_back(field, value);
    }
  };
  command.add_option_function<std::vector<std::string>>(OptionFor(field), add, option.get_description())
      ->type_name(option.get_type_name())
      ->allow_extra_args(false)
      ->group(group);
}

/// Offers the options in the table of `run` that this build's commands have. Those of several commands are offered
/// once.
void AddOptionsOfSteps(CLI::App& command, const std::shared_ptr<RunOptions>& options) {
  CLI::App app;
  AddCommandsOfSteps(app);
  for (const RunOption& row : RunOptionTable()) {
    const std::string field(row.field);
    const CLI::App* const other = app.get_subcommand(std::string(row.command));
    const CLI::Option* const option = other->get_option_no_throw(OptionFor(field));
    if (option == nullptr || command.get_option_no_throw(OptionFor(field)) != nullptr) continue;
    AddOptionOf(*other, *option, field, command, options);
  }
  const bool has_networks = app.get_subcommand("train")->get_option_no_throw("--epochs") != nullptr;
  if (!has_networks) options->trains = false;
}

}  // namespace

void AddRunCommand(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand(
      "run", "Everything: from the videos of a recording to 3D poses, a page to look at, files and a model");
  command
      ->add_option("input", options->inputs,
                   "The videos of all cameras, or folders that hold them; or a detector's keypoints, as for import")
      ->required()
      ->type_name("VIDEO|FOLDER");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for all results; killed or with other options, the same command does only what is not done")
      ->required()
      ->type_name("FOLDER");
  command->add_flag_callback(
      "--no-train", [options] { options->trains = false; }, "End with the page and the exports, without a network");
  command
      ->add_option_function<std::vector<std::string>>(
          "--export",
          [options](const std::vector<std::string>& formats) {
            options->formats = formats;
            options->formats_are_chosen = true;
          },
          fmt::format("Which files to write (default: csv,trc,c3d,bvh); of {}", SceneFormatNames()))
      ->type_name("EXT,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--format", options->format, "Format of keypoints (default: recognised by their content)")
      ->type_name("FORMAT");
  AddOptionsOfSteps(*command, options);
  command->footer(
      "The options of each step are explained by canonpose help STEP; commands.sh in the folder has the steps.");
  command->callback([options] { RunRun(*options); });
}

}  // namespace canonpose
