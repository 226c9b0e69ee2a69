#include "canonpose/model/morph.h"

#include "canonpose/base/random.h"
#include "canonpose/model/uniform_initialisation.h"

namespace canonpose {

MorphImpl::MorphImpl(int joint_count, int width)
    : upscale_(register_module("upscale", torch::nn::Linear(3 * joint_count, width))),
      block1_(register_module("block1", ResidualBlock(width))),
      block2_(register_module("block2", ResidualBlock(width))),
      offset_(register_module("offset", torch::nn::Linear(width, 2 * joint_count))) {}

torch::Tensor MorphImpl::forward(const torch::Tensor& input) { return offset_(block2_(block1_(upscale_(input)))); }

void MorphImpl::Initialise(std::uint64_t seed) {
  const torch::NoGradGuard no_grad;
  InitialiseUniformly(*this, seed);
  offset_->weight.zero_();
  offset_->bias.zero_();
}

}  // namespace canonpose
