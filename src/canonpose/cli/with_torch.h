// What the commands do with networks. A build without LibTorch has other definitions (without_torch.cc): they say so.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose {

/// Networks are computed by one thread from now on; training chooses for itself.
void UseOneThread();

/// The library that multiplies matrices here, and how fast it is, as JSON; "null" without LibTorch.
std::string DescribeLinearAlgebra();

/// Whether training has an option of this name.
bool IsTrainingOption(const std::string& name);

/// What a training run's checkpoint says of its model; nothing where the file is not a checkpoint.
std::optional<ModelInfo> CheckpointInfo(const std::filesystem::path& path);

/// Moves a detector's joints by a morphing network. `file` is the dataset's name for messages.
void ApplyMorph(const std::filesystem::path& model, Dataset& dataset, const std::string& file);

/// Evaluates what a model sees in each view by itself.
EvaluationReport EvaluateModel(const std::filesystem::path& model, const std::string& device,
                               const DatasetEvaluation& job);

}  // namespace canonpose
