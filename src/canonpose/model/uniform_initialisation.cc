#include "canonpose/model/uniform_initialisation.h"

#include <cmath>

#include "canonpose/base/random.h"

namespace canonpose {

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

}  // namespace canonpose
