#include "canonpose/model/martinez_lifter.h"

#include <cmath>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"

namespace canonpose {
namespace {

constexpr double kDropout = 0.5;

torch::Tensor Activate(const torch::Tensor& x, torch::nn::Linear& linear, torch::nn::BatchNorm1d& norm, bool training) {
  return torch::dropout(torch::relu(norm(linear(x))), kDropout, training);
}

}  // namespace

MartinezBlockImpl::MartinezBlockImpl(int width)
    : l1_(register_module("l1", torch::nn::Linear(width, width))),
      n1_(register_module("n1", torch::nn::BatchNorm1d(width))),
      l2_(register_module("l2", torch::nn::Linear(width, width))),
      n2_(register_module("n2", torch::nn::BatchNorm1d(width))) {}

torch::Tensor MartinezBlockImpl::forward(const torch::Tensor& x) {
  return x + Activate(Activate(x, l1_, n1_, is_training()), l2_, n2_, is_training());
}

MartinezLifterImpl::MartinezLifterImpl(int joint_count, int width)
    : LiftingNetwork(joint_count, ConfidenceInput::kNone),
      first_(register_module("first", torch::nn::Linear(input_size(), width))),
      first_norm_(register_module("first_norm", torch::nn::BatchNorm1d(width))),
      block1_(register_module("block1", MartinezBlock(width))),
      block2_(register_module("block2", MartinezBlock(width))),
      pose3d_(register_module("pose3d", torch::nn::Linear(width, 3 * joint_count))) {}

LifterOutput MartinezLifterImpl::forward(const torch::Tensor& input) {
  const torch::Tensor x = Activate(Seen(input), first_, first_norm_, is_training());
  LifterOutput output;
  output.pose = pose3d_(block2_(block1_(x))).view({-1, 3, joint_count()});
  output.rotation = torch::eye(3, input.options()).expand({input.size(0), 3, 3});
  return output;
}

void MartinezLifterImpl::Initialise(std::uint64_t seed) {
  const torch::NoGradGuard no_grad;
  Rng rng(seed);
  for (const auto& item : named_parameters()) {
    torch::Tensor parameter = item.value();
    const bool is_linear = parameter.dim() == 2;
    const bool is_gain = !is_linear && item.key().ends_with("weight");
    torch::Tensor values = torch::full(parameter.sizes(), is_gain ? 1.0 : 0.0, torch::kFloat32);
    if (is_linear) {
      const double scatter = std::sqrt(2.0 / static_cast<double>(parameter.size(1)));
      float* data = values.data_ptr<float>();
      for (std::int64_t i = 0; i < values.numel(); ++i) data[i] = static_cast<float>(scatter * rng.Normal());
    }
    parameter.copy_(values);
  }
}

void MartinezLifterImpl::ScaleRotations(double) { CANONPOSE_CHECK(false, "the network has no rotations"); }

void MartinezLifterImpl::MirrorRows(const std::string& name, torch::Tensor& tensor) const {
  const torch::NoGradGuard no_grad;
  if (name == "pose3d.weight" || name == "pose3d.bias") tensor.narrow(0, 2 * joint_count(), joint_count()).neg_();
}

}  // namespace canonpose
