// What training knows without LibTorch.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/cli/with_torch.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/options.h"

namespace canonpose {

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

}  // namespace canonpose
