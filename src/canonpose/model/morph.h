// Skeleton morphing: a network that moves a detector's 2D joints to where another skeleton has them.
//
// Wandt et al., "CanonPose", CVPR 2021, section 3.5: detectors and benchmarks mean different points by the same joint.
#pragma once

#include <cstdint>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"

namespace canonpose {

/// Input (B, 3J) as for a lifter: a normalised 2D pose, planar, and its confidences. Output (B, 2J): what to add to the
/// 2D pose, planar and in its unit. Fully connected to `width`, two residual blocks, and a linear layer.
class MorphImpl : public torch::nn::Module {
 public:
  MorphImpl(int joint_count, int width);
  torch::Tensor forward(const torch::Tensor& input);

  /// As LifterImpl::Initialise(), but the last layer is zero: an untrained network moves nothing.
  void Initialise(std::uint64_t seed);

 private:
  torch::nn::Linear upscale_;
  ResidualBlock block1_;
  ResidualBlock block2_;
  torch::nn::Linear offset_;
};
TORCH_MODULE(Morph);

}  // namespace canonpose
