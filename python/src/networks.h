// What other sources need of networks.cc; without LibTorch, networks_absent.cc reports that networks are missing.
#pragma once

#include <filesystem>
#include <string>

#include "canonpose/evaluate/report.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose::python {

EvaluationReport EvaluateModel(const std::filesystem::path& model, const std::string& device,
                               const DatasetEvaluation& job);

}  // namespace canonpose::python
