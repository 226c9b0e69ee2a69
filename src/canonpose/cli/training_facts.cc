// What training knows without LibTorch.
#include "canonpose/cli/with_torch.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/options.h"

namespace canonpose {

bool IsTrainingOption(const std::string& name) { return TrainOptions::Has(name); }

std::optional<ModelInfo> CheckpointInfo(const std::filesystem::path& path) {
  if (!IsCheckpoint(path)) return std::nullopt;
  return ReadCheckpoint(path).info;
}

}  // namespace canonpose
