#include "canonpose/model/tensors.h"

#include <algorithm>

#include "canonpose/base/error.h"
#include "canonpose/model/martinez_lifter.h"

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

namespace {

/// The parameters and statistics of a network, without the number of batches that the statistics were taken over, which
/// nothing uses.
torch::OrderedDict<std::string, torch::Tensor> TensorsOf(const torch::nn::Module& network) {
  torch::OrderedDict<std::string, torch::Tensor> tensors = network.named_parameters();
  for (const auto& item : network.named_buffers()) {
    if (!item.key().ends_with("num_batches_tracked")) tensors.insert(item.key(), item.value());
  }
  return tensors;
}

}  // namespace

NamedArrays StatisticsOf(const torch::nn::Module& network) {
  NamedArrays arrays = ParametersOf(network);
  for (const auto& item : network.named_parameters()) arrays.erase(item.key());
  return arrays;
}

NamedArrays ParametersOf(const torch::nn::Module& network) {
  NamedArrays arrays;
  for (const auto& item : TensorsOf(network)) arrays[item.key()] = ToArray(item.value());
  return arrays;
}

void LoadParameters(torch::nn::Module& network, const NamedArrays& parameters, const std::string& file) {
  const torch::NoGradGuard no_grad;
  for (auto& item : TensorsOf(network)) {
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

std::shared_ptr<LiftingNetwork> MakeNetwork(const ModelInfo& info) {
  const int joints = info.skeleton.joint_count();
  if (info.network == NetworkKind::kMartinez) return MartinezLifter(joints, info.width).ptr();
  CANONPOSE_CHECK(info.network == NetworkKind::kCanonical, "{} is not a lifter", ToString(info.network));
  return Lifter(joints, info.width, info.rotation, info.input.confidences).ptr();
}

std::shared_ptr<LiftingNetwork> MakeLifter(const ModelFile& model, const std::string& file, torch::Device device) {
  if (model.info.network == NetworkKind::kMorph) {
    ThrowBadInput({file, "", "a lifter", "a network that morphs 2D poses", "give it as `morph`, and a lifter here"});
  }
  std::shared_ptr<LiftingNetwork> network = MakeNetwork(model.info);
  LoadParameters(*network, model.parameters, file);
  network->to(device);
  network->eval();
  return network;
}

}  // namespace canonpose
