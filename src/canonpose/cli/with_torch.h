// What the commands do with networks. There are three programs: `canonpose-networks` has all commands (with_torch.cc);
// `canonpose` has those without networks, starts at once, and becomes the former for the others (light_program.cc); and
// in a build without LibTorch, `canonpose` reports that networks are missing (without_torch.cc).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose {

/// To be called first, with what main() got: where these arguments ask for networks that are in another program, that
/// one takes this one's place. Throws Error(kBadInput) where there is none.
void BeginWithNetworks(int argc, char** argv);

/// The folders in which `canonpose` may be, if this program is in `folder`.
std::vector<std::filesystem::path> PlacesOfProgram(const std::filesystem::path& folder);

/// Networks are computed by one thread while the result lives, except in training, which chooses for itself.
std::shared_ptr<const void> UseOneThread();

/// The library that multiplies matrices here, and how fast it is, as JSON; "null" without LibTorch.
std::string DescribeLinearAlgebra();

/// Whether training has an option of this name.
bool IsTrainingOption(const std::string& name);

/// Throws Error(kInvalidArgument) where options of `train`, by field, are unknown or have no such value. Those given by
/// "set" are NAME=VALUE.
void CheckTrainingOptions(const std::vector<std::pair<std::string, std::string>>& fields);

/// What a training run's checkpoint says about its model; nothing if the file is not a checkpoint.
std::optional<ModelInfo> CheckpointInfo(const std::filesystem::path& path);

/// Moves a detector's joints by a morphing network. `file` is the dataset's name for messages.
void ApplyMorph(const std::filesystem::path& model, Dataset& dataset, const std::string& file);

/// Evaluates a model's poses of each view by itself.
EvaluationReport EvaluateModel(const std::filesystem::path& model, const std::string& device,
                               const DatasetEvaluation& job);

}  // namespace canonpose
