#include "canonpose/cli/with_torch.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/pipeline/model_poses.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/options.h"

namespace canonpose {

std::shared_ptr<const void> UseOneThread() { return std::make_shared<const ThreadScope>(0); }

std::string DescribeLinearAlgebra() {
  const LinearAlgebraSpeed speed = MeasureLinearAlgebra();
  return nlohmann::json{
      {"library", LinearAlgebraLibrary()}, {"gflops", speed.gflops}, {"openblas_gflops", speed.openblas_gflops}}
      .dump();
}

bool IsTrainingOption(const std::string& name) { return TrainOptions::Has(name); }

void CheckTrainingOptions(const std::vector<std::pair<std::string, std::string>>& fields) {
  TrainOptions options = PresetOptions("best");
  for (const auto& [field, value] : fields) {
    if (field == "preset") options = PresetOptions(value);
  }
  for (const auto& [field, value] : fields) {
    const std::size_t equals = std::min(value.find('='), value.size());
    if (field == "set") {
      options.Set(value.substr(0, equals), value.substr(std::min(equals + 1, value.size())));
    } else if (TrainOptions::Has(field) && field != "preset") {
      options.Set(field, value);
    }
  }
  options.Validate();
}

std::optional<ModelInfo> CheckpointInfo(const std::filesystem::path& path) {
  if (!IsCheckpoint(path)) return std::nullopt;
  return ReadCheckpoint(path).info;
}

void ApplyMorph(const std::filesystem::path& model, Dataset& dataset, const std::string& file) {
  PoseMorph::Open(model).Apply(dataset, file);
}

EvaluationReport EvaluateModel(const std::filesystem::path& model, const std::string& device,
                               const DatasetEvaluation& job) {
  const PoseLifter lifter = PoseLifter::Open(model, device);
  if (job.canonical && lifter.info().network != NetworkKind::kCanonical) {
    ThrowInvalidArgument("`canonical` is for models with a canonical pose: {} predicts poses in the camera alone",
                         model.string());
  }
  return EvaluateDatasets(job, ModelPoses(lifter));
}

}  // namespace canonpose
