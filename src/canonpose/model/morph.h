// Skeleton morphing: a network that moves a detector's 2D joints to where another skeleton has them, since detectors
// and benchmarks place the joints of the same name at different points of the body.
//
// Wandt et al., "CanonPose", CVPR 2021, section 3.5.
#pragma once

#include <cstdint>

#include <torch/torch.h>

#include "canonpose/model/lifter.h"

namespace canonpose {

/// Input (B, 3J) as for a lifter: a normalised 2D pose, planar (all x, then all y), and its confidences. Output (B,
/// 2J): the offset to add to the pose, planar and in its unit. The layers are a linear one to `width`, two residual
/// blocks and a linear one.
class MorphImpl : public torch::nn::Module {
 public:
  MorphImpl(int joint_count, int width);
  torch::Tensor forward(const torch::Tensor& input);

  /// As LifterImpl::Initialise(), with the last layer zero: an untrained network moves nothing.
  void Initialise(std::uint64_t seed);

 private:
  torch::nn::Linear upscale_;
  ResidualBlock block1_;
  ResidualBlock block2_;
  torch::nn::Linear offset_;
};
TORCH_MODULE(Morph);

}  // namespace canonpose
