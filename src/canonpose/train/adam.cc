#include "canonpose/train/adam.h"

#include <cmath>

#include <ATen/Parallel.h>

#include "canonpose/train/adam_update.h"

namespace canonpose {
namespace {

constexpr double kBeta1 = 0.9;
constexpr double kBeta2 = 0.999;
constexpr double kEpsilon = 1e-8;
constexpr std::int64_t kGrain = 1 << 15;

struct StepSizes {
  double learning_rate;    // rate / (1 - b1^t)
  double root_correction;  // sqrt(1 - b2^t)
  double weight_decay;
};

template <typename T>
void UpdateOnCpu(Adam::Parameter& parameter, const torch::Tensor& gradient, const StepSizes& sizes) {
  T* value = parameter.value.data_ptr<T>();
  T* first = parameter.first_moment.data_ptr<T>();
  T* second = parameter.second_moment.data_ptr<T>();
  const T* grad = gradient.data_ptr<T>();
  const AdamConstants<T> constants{static_cast<T>(sizes.learning_rate),
                                   static_cast<T>(1.0 / sizes.root_correction),
                                   static_cast<T>(sizes.weight_decay),
                                   static_cast<T>(kBeta1),
                                   static_cast<T>(kBeta2),
                                   static_cast<T>(1.0 - kBeta1),
                                   static_cast<T>(1.0 - kBeta2),
                                   static_cast<T>(kEpsilon)};
  at::parallel_for(0, parameter.value.numel(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    UpdateParameters(end - begin, constants, grad + begin, value + begin, first + begin, second + begin);
  });
}

void UpdateAnywhere(Adam::Parameter& parameter, const torch::Tensor& gradient, const StepSizes& sizes) {
  const torch::Tensor g = gradient + sizes.weight_decay * parameter.value;
  parameter.first_moment.mul_(kBeta1).add_(g, 1.0 - kBeta1);
  parameter.second_moment.mul_(kBeta2).addcmul_(g, g, 1.0 - kBeta2);
  const torch::Tensor denominator = (parameter.second_moment.sqrt() / sizes.root_correction).add_(kEpsilon);
  parameter.value.addcdiv_(parameter.first_moment, denominator, -sizes.learning_rate);
}

}  // namespace

Adam::Adam(const std::vector<std::pair<std::string, torch::Tensor>>& parameters, double weight_decay)
    : weight_decay_(weight_decay) {
  for (const auto& [name, value] : parameters) {
    const torch::Tensor detached = value.detach();
    parameters_.push_back({name, value, torch::zeros_like(detached), torch::zeros_like(detached)});
  }
}

void Adam::Step(double learning_rate) {
  const torch::NoGradGuard no_grad;
  ++step_count_;
  const auto t = static_cast<double>(step_count_);
  const StepSizes sizes{learning_rate / (1.0 - std::pow(kBeta1, t)), std::sqrt(1.0 - std::pow(kBeta2, t)),
                        weight_decay_};
  for (Parameter& parameter : parameters_) {
    const torch::Tensor gradient = parameter.value.grad();
    if (!gradient.defined()) continue;
    const bool plain = parameter.value.is_cpu() && parameter.value.is_contiguous() && gradient.is_contiguous();
    if (plain && parameter.value.scalar_type() == torch::kFloat32) {
      UpdateOnCpu<float>(parameter, gradient, sizes);
    } else if (plain && parameter.value.scalar_type() == torch::kFloat64) {
      UpdateOnCpu<double>(parameter, gradient, sizes);
    } else {
      UpdateAnywhere(parameter, gradient, sizes);
    }
    parameter.value.mutable_grad().reset();
  }
}

}  // namespace canonpose
