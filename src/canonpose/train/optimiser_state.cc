#include "canonpose/train/optimiser_state.h"

#include "canonpose/base/error.h"
#include "canonpose/model/tensors.h"

namespace canonpose {

std::vector<std::pair<std::string, torch::Tensor>> NamedParameters(const torch::nn::Module& network) {
  std::vector<std::pair<std::string, torch::Tensor>> parameters;
  for (const auto& item : network.named_parameters()) parameters.emplace_back(item.key(), item.value());
  return parameters;
}

void StoreOptimiser(const Adam& adam, Checkpoint& checkpoint) {
  for (const Adam::Parameter& parameter : adam.parameters()) {
    checkpoint.parameters[parameter.name] = ToArray(parameter.value);
    checkpoint.first_moments[parameter.name] = ToArray(parameter.first_moment);
    checkpoint.second_moments[parameter.name] = ToArray(parameter.second_moment);
  }
}

void RestoreOptimiser(const Checkpoint& checkpoint, const std::string& file, Adam& adam) {
  const torch::NoGradGuard no_grad;
  for (Adam::Parameter& parameter : adam.parameters()) {
    const auto restore = [&](const NamedArrays& arrays, torch::Tensor& tensor) {
      const auto found = arrays.find(parameter.name);
      if (found == arrays.end() || static_cast<std::int64_t>(found->second.values.size()) != tensor.numel()) {
        ThrowBadInput(
            {file, parameter.name, "the optimiser's state", "none that fits", "the file is damaged: train again"});
      }
      tensor.copy_(ToTensor(found->second).view(tensor.sizes()));
    };
    restore(checkpoint.parameters, parameter.value);
    restore(checkpoint.first_moments, parameter.first_moment);
    restore(checkpoint.second_moments, parameter.second_moment);
  }
}

void ResetOptimiser(Adam& adam) {
  for (Adam::Parameter& parameter : adam.parameters()) {
    parameter.first_moment.zero_();
    parameter.second_moment.zero_();
  }
  adam.set_step_count(0);
}

}  // namespace canonpose
