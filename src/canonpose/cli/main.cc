// canonpose COMMAND: the table of commands.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/version.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/interrupt.h"
#include "canonpose/cli/option_names.h"
#include "canonpose/cli/terminal.h"
#include "canonpose/cli/usage.h"
#include "canonpose/cli/with_torch.h"

namespace canonpose {
namespace {

/// Exit codes of the command line, a contract with callers. Commands that a signal stops exit with 128 + its number
/// (interrupt.h): 130, or 143 after SIGTERM.
enum class ExitCode {
  kDone = 0,
  kUsage = 2,
  kBadInput = 3,     ///< a file cannot be what it should be, or cannot be read or written
  kComputation = 4,  ///< the computation failed: diverged, too few views, ...
};

int ExitCodeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInvalidArgument:
      return static_cast<int>(ExitCode::kUsage);
    case ErrorKind::kBadInput:
      return static_cast<int>(ExitCode::kBadInput);
    case ErrorKind::kComputation:
      return static_cast<int>(ExitCode::kComputation);
    case ErrorKind::kStopped:
      return StopOnSignal::exit_code();
  }
  return static_cast<int>(ExitCode::kComputation);
}

/// Names of files may hold anything, but a message is one line.
std::string OneLine(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

/// Failures of libraries, in one line: LibTorch's end in a stack of C++ frames.
int ReportUnexpected(const Terminal& terminal, const std::string& what) {
  const std::string line = what.substr(0, what.find('\n'));
  if (line.find("not enough memory") != std::string::npos || line.find("out of memory") != std::string::npos) {
    terminal.Print("error: out of memory; close other programs, or use a smaller --width or recording");
  } else {
    terminal.Print(
        fmt::format("error: {} (this is a fault in canonpose: please report it with the command you ran)", line));
  }
  return static_cast<int>(ExitCode::kComputation);
}

/// Checks that everything printed was written, even if the disk is full.
int FinishOutput(const Terminal& terminal) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout.good()) return static_cast<int>(ExitCode::kDone);
  terminal.Print(
      "error: standard output: the results could not be written completely; free some space and run the command again");
  return static_cast<int>(ExitCode::kBadInput);
}

int Main(int argc, char** argv) {
  CLI::App app("3D human pose from a single view, learned from a few uncalibrated cameras without any label.",
               "canonpose");
  app.set_version_flag("--version", ProgramVersion());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 the computation failed, 130 interrupted (143 by SIGTERM).\n"
      "canonpose help COMMAND shows the options of a command.");

  Terminal terminal([&app](const std::string& message) { return SpellOptions(message, app, IsTrainingOption); });
  AddCommands(app);
  AddHelpCommands(app);

  const CallbackScope callbacks(terminal.MakeCallbacks());
  try {
    BeginWithNetworks(argc, argv);
    const std::shared_ptr<const void> one_thread = UseOneThread();  // training has its own
    std::vector<std::string> arguments = WithoutHelpWords({argv + std::min(argc, 1), argv + argc});
    RequireCommand(app, arguments);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(std::move(arguments));
    return FinishOutput(terminal);
  } catch (const CLI::RuntimeError& stop) {  // a signal stopped the command, which has said so
    return stop.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error);
      return FinishOutput(terminal);
    }
    terminal.Print("error: " + OneLine(DescribeMistake(app, error)));
    return static_cast<int>(ExitCode::kUsage);
  } catch (const Error& error) {
    terminal.Print("error: " + OneLine(SpellOptions(error.what(), app, IsTrainingOption)));
    return ExitCodeOf(error.kind());
  } catch (const std::bad_alloc&) {
    return ReportUnexpected(terminal, "out of memory");
  } catch (const std::filesystem::filesystem_error& error) {
    terminal.Print(
        OneLine(fmt::format("error: {}: {}; check the path", error.path1().string(), error.code().message())));
    return static_cast<int>(ExitCode::kBadInput);
  } catch (const std::exception& error) {
    return ReportUnexpected(terminal, error.what());
  }
}

}  // namespace
}  // namespace canonpose

// NOLINTNEXTLINE(bugprone-exception-escape): what the handlers of Main throw ends the process.
int main(int argc, char** argv) { return canonpose::Main(argc, argv); }
