#include "canonpose/train/adam.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

/// A loss with a gradient that changes from step to step.
torch::Tensor Loss(const torch::Tensor& x, int step) {
  return ((x - 0.1 * step) * (x - 0.1 * step) * (1 + x * x)).sum();
}

TEST(Adam, AgreesWithLibTorchInFloatAndDouble) {
  for (const torch::Dtype dtype : {torch::kFloat32, torch::kFloat64}) {
    torch::manual_seed(1);
    const torch::Tensor start = torch::randn({70000}, dtype);
    torch::Tensor ours = start.clone().requires_grad_();
    torch::Tensor theirs = start.clone().requires_grad_();
    Adam adam({{"x", ours}}, 1e-2);
    torch::optim::Adam reference({theirs}, torch::optim::AdamOptions(1e-2).weight_decay(1e-2));
    for (int step = 0; step < 20; ++step) {
      Loss(ours, step).backward();
      adam.Step(1e-2);
      reference.zero_grad();
      Loss(theirs, step).backward();
      reference.step();
    }
    const double tolerance = dtype == torch::kFloat32 ? 2e-5 : 1e-12;
    EXPECT_TRUE(torch::allclose(ours, theirs, tolerance, tolerance)) << (ours - theirs).abs().max().item<double>();
  }
}

TEST(Adam, FusedAndGeneralPathsAgree) {
  torch::manual_seed(2);
  const torch::Tensor start = torch::randn({100, 3}, torch::kFloat64);
  torch::Tensor contiguous = start.clone().requires_grad_();
  torch::Tensor strided = start.t().contiguous().t().requires_grad_();  // not contiguous: takes the general path
  ASSERT_FALSE(strided.is_contiguous());
  Adam a({{"x", contiguous}}, 1e-5);
  Adam b({{"x", strided}}, 1e-5);
  for (int step = 0; step < 5; ++step) {
    Loss(contiguous, step).backward();
    Loss(strided, step).backward();
    a.Step(1e-3);
    b.Step(1e-3);
  }
  EXPECT_TRUE(torch::allclose(contiguous, strided, 0, 1e-13));
  EXPECT_FALSE(contiguous.grad().defined());  // cleared
}

}  // namespace
}  // namespace canonpose
