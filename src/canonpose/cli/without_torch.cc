// The commands of a build without LibTorch: those that need networks say how to get a build with them.
#include <memory>
#include <string>

#include "canonpose/base/error.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/with_torch.h"

namespace canonpose {
namespace {

[[noreturn]] void ThrowWithoutTorch(const std::string& what) {
  ThrowInvalidArgument(
      "{} needs networks, and this canonpose was built without LibTorch; build it with "
      "CANONPOSE_WITH_TORCH=ON",
      what);
}

void AddAbsentCommand(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* command = app.add_subcommand(name, help + " (not in this build: it is without LibTorch)");
  command->allow_extras();
  command->callback([name] { ThrowWithoutTorch(name); });
}

}  // namespace

void AddDetectCommand(CLI::App& app) { AddAbsentCommand(app, "detect", "Find people's 2D keypoints in videos"); }

void AddTrainCommand(CLI::App& app) { AddAbsentCommand(app, "train", "Train a lifter on datasets"); }

void AddTrainMorphCommand(CLI::App& app) {
  AddAbsentCommand(app, "train-morph", "Train a network that moves a detector's 2D joints");
}

void AddLiftCommand(CLI::App& app) { AddAbsentCommand(app, "lift", "Lift the 2D poses of a single camera to 3D"); }

void BeginWithNetworks(int, char**) {}

std::vector<std::filesystem::path> PlacesOfProgram(const std::filesystem::path& folder) { return {folder}; }

std::shared_ptr<const void> UseOneThread() { return nullptr; }

std::string DescribeLinearAlgebra() { return "null"; }

bool IsTrainingOption(const std::string&) { return false; }

void CheckTrainingOptions(const std::vector<std::pair<std::string, std::string>>&) { ThrowWithoutTorch("training"); }

std::optional<ModelInfo> CheckpointInfo(const std::filesystem::path&) { return std::nullopt; }

void ApplyMorph(const std::filesystem::path&, Dataset&, const std::string&) { ThrowWithoutTorch("--morph"); }

EvaluationReport EvaluateModel(const std::filesystem::path&, const std::string&, const DatasetEvaluation&) {
  ThrowWithoutTorch("evaluating a model");
}

}  // namespace canonpose
