// One function per command: it adds the subcommand and its options to the app; the subcommand's callback does the work.
//
// Callbacks throw canonpose::Error; main() turns that into one line and an exit code. Results go to stdout, everything
// else through base/log.h to stderr.
#pragma once

#include <CLI/CLI.hpp>

namespace canonpose {

/// All commands, in the order of the help.
void AddCommands(CLI::App& app);
/// Those that `run` may execute: all but itself.
void AddCommandsOfSteps(CLI::App& app);

void AddRunCommand(CLI::App& app);
void AddDetectCommand(CLI::App& app);
void AddImportCommand(CLI::App& app);
void AddSimulateCommand(CLI::App& app);
void AddTrainCommand(CLI::App& app);
void AddTrainMorphCommand(CLI::App& app);
void AddEvaluateCommand(CLI::App& app);
void AddLiftCommand(CLI::App& app);
void AddSolveCommand(CLI::App& app);
void AddExportCommand(CLI::App& app);
void AddViewCommand(CLI::App& app);
void AddInfoCommand(CLI::App& app);

}  // namespace canonpose
