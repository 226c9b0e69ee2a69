// canonpose COMMAND: the table of commands.
#include <CLI/CLI.hpp>
#include <exception>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/version.h"
#include "canonpose/cli/commands.h"

namespace canonpose {
namespace {

int Main(int argc, char** argv) {
  CLI::App app("3D human pose from a single view, learned from a few uncalibrated cameras without any label.", "canonpose");
  app.set_version_flag("--version", ProgramVersion());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 the computation failed, 130 interrupted.\n"
      "canonpose COMMAND --help tells more about a command.");

  AddImportCommand(app);
  AddTrainCommand(app);
  AddEvaluateCommand(app);
  AddLiftCommand(app);
  AddInfoCommand(app);

  try {
    app.parse(argc, argv);
    return static_cast<int>(ExitCode::kDone);
  } catch (const CLI::RuntimeError& stop) {
    return stop.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    LogInfo("error: {} (canonpose --help and canonpose COMMAND --help tell what there is)", error.what());
    return static_cast<int>(ExitCode::kUsage);
  } catch (const Error& error) {
    LogInfo("error: {}", error.what());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    LogInfo("error: out of memory; close other programs or use a smaller recording or --width");
    return static_cast<int>(ExitCode::kComputation);
  } catch (const std::exception& error) {
    LogInfo("error: {} (this is a fault in canonpose: please report it with the command you ran)", error.what());
    return static_cast<int>(ExitCode::kComputation);
  }
}

}  // namespace
}  // namespace canonpose

int main(int argc, char** argv) { return canonpose::Main(argc, argv); }
