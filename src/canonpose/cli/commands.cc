#include "canonpose/cli/commands.h"

namespace canonpose {

void AddCommands(CLI::App& app) {
  AddRunCommand(app);
  AddCommandsOfSteps(app);
}

void AddCommandsOfSteps(CLI::App& app) {
  AddDetectCommand(app);
  AddImportCommand(app);
  AddSimulateCommand(app);
  AddTrainCommand(app);
  AddTrainMorphCommand(app);
  AddEvaluateCommand(app);
  AddLiftCommand(app);
  AddSolveCommand(app);
  AddExportCommand(app);
  AddViewCommand(app);
  AddInfoCommand(app);
}

}  // namespace canonpose
