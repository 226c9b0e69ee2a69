// Initial parameters of our networks.
#pragma once

#include <cstdint>

#include <torch/torch.h>

namespace canonpose {

/// Draws all parameters uniformly from +-1/sqrt(fan in), PyTorch's default for linear layers, with our own generator:
/// the same numbers on every machine and version.
void InitialiseUniformly(torch::nn::Module& network, std::uint64_t seed);

}  // namespace canonpose
