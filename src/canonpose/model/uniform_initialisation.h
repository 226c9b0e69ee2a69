// How our networks start.
#pragma once

#include <cstdint>

#include <torch/torch.h>

namespace canonpose {

/// Draws all parameters uniformly in +-1/sqrt(fan in) (PyTorch's default for linear layers), from our own generator:
/// the same on every machine and version.
void InitialiseUniformly(torch::nn::Module& network, std::uint64_t seed);

}  // namespace canonpose
