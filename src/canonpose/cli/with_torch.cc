#include "canonpose/cli/with_torch.h"

#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/pipeline/model_poses.h"

namespace canonpose {

void BeginWithNetworks(int, char**) {}

std::vector<std::filesystem::path> PlacesOfProgram(const std::filesystem::path& folder) {
  return {folder, folder / CANONPOSE_BIN_FROM_LIBEXEC};
}

std::shared_ptr<const void> UseOneThread() { return std::make_shared<const ThreadScope>(0); }

std::string DescribeLinearAlgebra() {
  const LinearAlgebraSpeed speed = MeasureLinearAlgebra();
  return nlohmann::json{
      {"library", LinearAlgebraLibrary()}, {"gflops", speed.gflops}, {"openblas_gflops", speed.openblas_gflops}}
      .dump();
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
