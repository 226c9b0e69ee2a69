#include "canonpose/train/loss_sums.h"

namespace canonpose {

LossSums::LossSums(torch::Device device)
    : sums_(torch::zeros({4}, torch::TensorOptions(device).dtype(torch::kFloat64))) {}

void LossSums::Add(const Losses& losses) {
  const torch::NoGradGuard no_grad;
  ++steps_;
  if (!losses.view.defined()) {
    sums_.select(0, 0).add_(losses.total);
    return;
  }
  sums_.add_(torch::stack({losses.total, losses.reprojection, losses.view, losses.camera}));
}

EpochSums LossSums::Read() const {
  const torch::Tensor on_cpu = sums_.to(torch::kCPU);
  const double* values = on_cpu.data_ptr<double>();
  EpochSums sums;
  sums.total = values[0];
  sums.reprojection = values[1];
  sums.view = values[2];
  sums.camera = values[3];
  sums.steps = steps_;
  return sums;
}

void LossSums::Set(const EpochSums& sums) {
  const torch::Tensor values =
      torch::tensor({sums.total, sums.reprojection, sums.view, sums.camera}, torch::TensorOptions(torch::kFloat64));
  sums_.copy_(values);
  steps_ = sums.steps;
}

}  // namespace canonpose
