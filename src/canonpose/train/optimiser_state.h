// An optimiser's parameters and moments in a checkpoint.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"
#include "canonpose/train/adam.h"
#include "canonpose/train/checkpoint.h"

namespace canonpose {

/// All parameters of a network, in its order.
std::vector<std::pair<std::string, torch::Tensor>> NamedParameters(const torch::nn::Module& network);

/// Adds the values and moments of all parameters to a checkpoint.
void StoreOptimiser(const Adam& adam, Checkpoint& checkpoint);

/// Restores them; the step count is not among them. Throws Error(kBadInput) naming `file` where one is missing or has
/// another size.
void RestoreOptimiser(const Checkpoint& checkpoint, const std::string& file, Adam& adam);

/// Sets all moments and the step count to zero.
void ResetOptimiser(Adam& adam);

}  // namespace canonpose
