// Converts between LibTorch's tensors and the plain arrays of our files.
#pragma once

#include <memory>
#include <string>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

h5::Array<float> ToArray(const torch::Tensor& tensor);
/// A float32 tensor on the CPU that owns its data.
torch::Tensor ToTensor(const h5::Array<float>& array);

/// The running statistics of batch normalisation; empty for networks without it.
NamedArrays StatisticsOf(const torch::nn::Module& network);
/// All parameters and statistics.
NamedArrays ParametersOf(const torch::nn::Module& network);
/// Copies parameters and statistics into a network. Throws Error(kBadInput) naming `file` where one is missing or has
/// another shape.
void LoadParameters(torch::nn::Module& network, const NamedArrays& parameters, const std::string& file);

/// A lifter of the form that a model describes, with uninitialised parameters.
std::shared_ptr<LiftingNetwork> MakeNetwork(const ModelInfo& info);
/// The lifter of a model file, in evaluation mode, on `device`. Throws Error(kBadInput) as LoadParameters() does, and
/// for a morphing network's model.
std::shared_ptr<LiftingNetwork> MakeLifter(const ModelFile& model, const std::string& file, torch::Device device);

}  // namespace canonpose
