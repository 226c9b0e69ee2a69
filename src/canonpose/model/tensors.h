// Between LibTorch's tensors and the plain arrays of our files.
#pragma once

#include <string>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

h5::Array<float> ToArray(const torch::Tensor& tensor);
/// A float32 tensor on the CPU that owns its data.
torch::Tensor ToTensor(const h5::Array<float>& array);

NamedArrays ParametersOf(const Lifter& lifter);
/// Copies parameters into the network. Throws Error(kBadInput) naming `file` where one is missing or has another shape.
void LoadParameters(Lifter& lifter, const NamedArrays& parameters, const std::string& file);

/// The network of a model file, in evaluation mode, on `device`.
Lifter MakeLifter(const ModelFile& model, const std::string& file, torch::Device device);

}  // namespace canonpose
