// Adam (Kingma and Ba 2015) with L2 weight decay, whose state checkpoints and the mirror can access.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <torch/torch.h>

namespace canonpose {

/// Computes what PyTorch's computes:
///
///   g += decay p;  m = b1 m + (1 - b1) g;  v = b2 v + (1 - b2) g^2
///   p -= rate / (1 - b1^t) m / (sqrt(v / (1 - b2^t)) + eps),   b1 = 0.9, b2 = 0.999, eps = 1e-8
///
/// On the CPU it takes one pass over memory, which is what limits its speed. LibTorch's own takes several passes, and
/// its interface differs between versions.
class Adam {
 public:
  struct Parameter {
    std::string name;
    torch::Tensor value;
    torch::Tensor first_moment;
    torch::Tensor second_moment;
  };

  /// Keeps references to the parameters' tensors.
  Adam(const std::vector<std::pair<std::string, torch::Tensor>>& parameters, double weight_decay);

  /// One step from the gradients, which are then cleared. A parameter without a gradient stays as it is.
  void Step(double learning_rate);

  [[nodiscard]] std::vector<Parameter>& parameters() { return parameters_; }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] std::int64_t step_count() const { return step_count_; }
  void set_step_count(std::int64_t count) { step_count_ = count; }

 private:
  std::vector<Parameter> parameters_;
  double weight_decay_;
  std::int64_t step_count_ = 0;
};

}  // namespace canonpose
