#include "canonpose/model/tensors.h"

#include <algorithm>

#include "canonpose/base/error.h"

namespace canonpose {

h5::Array<float> ToArray(const torch::Tensor& tensor) {
  const torch::Tensor contiguous = tensor.detach().to(torch::kCPU, torch::kFloat32).contiguous();
  const float* data = contiguous.data_ptr<float>();
  h5::Array<float> array;
  array.values.assign(data, data + contiguous.numel());
  array.shape.assign(contiguous.sizes().begin(), contiguous.sizes().end());
  return array;
}

torch::Tensor ToTensor(const h5::Array<float>& array) {
  const std::vector<std::int64_t> shape(array.shape.begin(), array.shape.end());
  torch::Tensor tensor = torch::empty(shape, torch::kFloat32);
  std::copy(array.values.begin(), array.values.end(), tensor.data_ptr<float>());
  return tensor;
}

NamedArrays ParametersOf(const Lifter& lifter) {
  NamedArrays arrays;
  for (const auto& item : lifter->named_parameters()) arrays[item.key()] = ToArray(item.value());
  return arrays;
}

void LoadParameters(Lifter& lifter, const NamedArrays& parameters, const std::string& file) {
  const torch::NoGradGuard no_grad;
  for (const auto& item : lifter->named_parameters()) {
    const auto found = parameters.find(item.key());
    const std::vector<std::size_t> shape(item.value().sizes().begin(), item.value().sizes().end());
    if (found == parameters.end() || found->second.shape != shape) {
      ThrowBadInput({file, item.key(), "weights of shape " + h5::FormatShape(shape),
                     found == parameters.end() ? "none" : h5::FormatShape(found->second.shape),
                     "the file is damaged: train again or restore it"});
    }
    item.value().copy_(ToTensor(found->second));
  }
}

Lifter MakeLifter(const ModelFile& model, const std::string& file, torch::Device device) {
  Lifter lifter(model.info.skeleton.joint_count(), model.info.width, RotationFormNamed(model.info.rotation));
  LoadParameters(lifter, model.parameters, file);
  lifter->to(device);
  lifter->eval();
  return lifter;
}

}  // namespace canonpose
