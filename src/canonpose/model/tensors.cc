#include "canonpose/model/tensors.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"
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

/// The parameters and statistics of a network. The number of batches that statistics were taken over says nothing to
/// anybody.
torch::OrderedDict<std::string, torch::Tensor> TensorsOf(const torch::nn::Module& network) {
  torch::OrderedDict<std::string, torch::Tensor> tensors = network.named_parameters();
  for (const auto& item : network.named_buffers()) {
    if (!item.key().ends_with("num_batches_tracked")) tensors.insert(item.key(), item.value());
  }
  return tensors;
}

}  // namespace

void InitialiseUniformly(torch::nn::Module& network, std::uint64_t seed) {
  const torch::NoGradGuard no_grad;
  Rng rng(seed);
  double bound = 0.0;
  for (const auto& item : network.named_parameters()) {
    torch::Tensor parameter = item.value();
    // A bias follows its weight and has the same fan in.
    if (parameter.dim() == 2) bound = 1.0 / std::sqrt(static_cast<double>(parameter.size(1)));
    torch::Tensor values = torch::empty(parameter.sizes(), torch::kFloat32);
    float* data = values.data_ptr<float>();
    for (std::int64_t i = 0; i < values.numel(); ++i) data[i] = static_cast<float>(rng.Uniform(-bound, bound));
    parameter.copy_(values);
  }
}

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
  if (info.network == "martinez") return MartinezLifter(joints, info.width).ptr();
  CANONPOSE_CHECK(info.network == "canonical", "{} is no lifter", info.network);
  return Lifter(joints, info.width, RotationFormNamed(info.rotation), ConfidenceInputNamed(info.input.confidences))
      .ptr();
}

std::shared_ptr<LiftingNetwork> MakeLifter(const ModelFile& model, const std::string& file, torch::Device device) {
  if (model.info.network == kMorphNetwork) {
    ThrowBadInput({file, "", "a lifter", "a network that morphs 2D poses", "give it as --morph, and a lifter here"});
  }
  std::shared_ptr<LiftingNetwork> network = MakeNetwork(model.info);
  LoadParameters(*network, model.parameters, file);
  network->to(device);
  network->eval();
  return network;
}

}  // namespace canonpose
