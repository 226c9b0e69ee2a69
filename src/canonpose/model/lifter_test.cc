#include "canonpose/model/lifter.h"

#include <gtest/gtest.h>

#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {

const torch::TensorOptions kDouble(torch::kFloat64);

torch::Tensor Depths(const torch::Tensor& rotation, const torch::Tensor& pose) {
  return torch::bmm(rotation, pose).select(1, 2);
}

TEST(Rodrigues, GivesRotations) {
  torch::manual_seed(1);
  const torch::Tensor rotation = Rodrigues(3.0 * torch::randn({50, 3}, kDouble));
  const torch::Tensor identity = torch::eye(3, kDouble).expand({50, 3, 3});
  EXPECT_TRUE(torch::allclose(torch::bmm(rotation, rotation.transpose(1, 2)), identity, 0, 1e-12));
  EXPECT_TRUE(torch::allclose(torch::det(rotation), torch::ones({50}, kDouble), 0, 1e-12));
}

TEST(Rodrigues, QuarterTurnAboutZ) {
  const torch::Tensor rotation = Rodrigues(torch::tensor({{0.0, 0.0, 1.5707963267948966}}, kDouble));
  const torch::Tensor expected = torch::tensor({{{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}}, kDouble);
  EXPECT_TRUE(torch::allclose(rotation, expected, 0, 1e-12));
}

TEST(Rodrigues, GradientIsFiniteAtZero) {
  torch::Tensor axis_angle = torch::zeros({1, 3}, kDouble).requires_grad_();
  Rodrigues(axis_angle).sum().backward();
  EXPECT_TRUE(torch::isfinite(axis_angle.grad()).all().item<bool>());
}

TEST(RotationFromSix, GivesRotationsAndKeepsTheFirstDirection) {
  torch::manual_seed(7);
  const torch::Tensor six = 3.0 * torch::randn({50, 6}, kDouble);
  const torch::Tensor rotation = RotationFromSix(six);
  const torch::Tensor identity = torch::eye(3, kDouble).expand({50, 3, 3});
  EXPECT_TRUE(torch::allclose(torch::bmm(rotation.transpose(1, 2), rotation), identity, 0, 1e-12));
  EXPECT_TRUE(torch::allclose(torch::det(rotation), torch::ones({50}, kDouble), 0, 1e-12));
  const torch::Tensor along = (rotation.select(2, 0) * six.narrow(1, 0, 3)).sum(1);
  EXPECT_TRUE(torch::allclose(along, six.narrow(1, 0, 3).norm(2, 1), 0, 1e-12));
  // A rotation's own columns give it back.
  const torch::Tensor columns = torch::cat({rotation.select(2, 0), rotation.select(2, 1)}, 1);
  EXPECT_TRUE(torch::allclose(RotationFromSix(columns), rotation, 0, 1e-12));
}

TEST(RotationFromSix, GradientMatchesNumericOneAndIsFiniteAtZero) {
  torch::manual_seed(8);
  torch::Tensor six = torch::randn({2, 6}, kDouble).requires_grad_();
  const torch::Tensor weights = torch::randn({2, 3, 3}, kDouble);
  (RotationFromSix(six) * weights).sum().backward();
  for (std::int64_t i = 0; i < 12; ++i) {
    constexpr double kStep = 1e-6;
    const auto at = [&](double offset) {
      torch::Tensor moved = six.detach().clone();
      moved.view({-1})[i] += offset;
      return (RotationFromSix(moved) * weights).sum().item<double>();
    };
    EXPECT_NEAR(six.grad().view({-1})[i].item<double>(), (at(kStep) - at(-kStep)) / (2 * kStep), 1e-7) << i;
  }
  torch::Tensor zero = torch::zeros({1, 6}, kDouble).requires_grad_();
  RotationFromSix(zero).sum().backward();
  EXPECT_TRUE(torch::isfinite(zero.grad()).all().item<bool>());
}

class LifterOfForm : public ::testing::TestWithParam<RotationForm> {};

INSTANTIATE_TEST_SUITE_P(Lifter, LifterOfForm, ::testing::Values(RotationForm::kAxisAngle, RotationForm::kSix));

TEST_P(LifterOfForm, GradientMatchesNumericOne) {
  torch::manual_seed(2);
  Lifter lifter(4, 8, GetParam());
  lifter->Initialise(3);
  lifter->to(torch::kFloat64);
  const torch::Tensor input = torch::randn({5, 12}, kDouble);
  const torch::Tensor weights = torch::randn({5, 3, 4}, kDouble);
  const auto loss = [&] {
    const LifterOutput output = lifter->forward(input);
    return (torch::bmm(output.rotation, output.pose) * weights).sum();
  };
  loss().backward();
  for (const auto& item : lifter->named_parameters()) {
    torch::Tensor flat = item.value().detach().view({-1});
    const torch::Tensor gradient = item.value().grad().view({-1});
    for (const std::int64_t index : {std::int64_t{0}, flat.numel() - 1}) {
      constexpr double kStep = 1e-6;
      const double original = flat[index].item<double>();
      flat[index] = original + kStep;
      const double above = loss().item<double>();
      flat[index] = original - kStep;
      const double below = loss().item<double>();
      flat[index] = original;
      EXPECT_NEAR(gradient[index].item<double>(), (above - below) / (2 * kStep), 1e-6) << item.key() << " " << index;
    }
  }
}

TEST_P(LifterOfForm, MirrorNegatesDepthsAndKeepsReprojections) {
  torch::manual_seed(4);
  Lifter lifter(17, 32, GetParam());
  lifter->Initialise(5);
  lifter->to(torch::kFloat64);
  const torch::NoGradGuard no_grad;
  const torch::Tensor input = torch::randn({9, 51}, kDouble);
  const LifterOutput before = lifter->forward(input);
  lifter->Mirror();
  const LifterOutput after = lifter->forward(input);
  const torch::Tensor in_camera_before = torch::bmm(before.rotation, before.pose);
  const torch::Tensor in_camera_after = torch::bmm(after.rotation, after.pose);
  EXPECT_TRUE(torch::allclose(in_camera_before.narrow(1, 0, 2), in_camera_after.narrow(1, 0, 2), 0, 1e-12));
  EXPECT_TRUE(torch::allclose(in_camera_before.select(1, 2), -in_camera_after.select(1, 2), 0, 1e-12));
  // Poses mixed with the rotations of other rows too: this is what the losses see.
  EXPECT_TRUE(torch::allclose(Depths(before.rotation.roll(1, 0), before.pose),
                              -Depths(after.rotation.roll(1, 0), after.pose), 0, 1e-12));
  const torch::Tensor flip = torch::diag(torch::tensor({1.0, 1.0, -1.0}, kDouble));
  EXPECT_TRUE(torch::allclose(after.rotation, flip.matmul(before.rotation).matmul(flip), 0, 1e-14));
  lifter->Mirror();
  const LifterOutput twice = lifter->forward(input);
  EXPECT_TRUE(torch::equal(before.pose, twice.pose));
  EXPECT_TRUE(torch::equal(before.rotation, twice.rotation));
}

TEST(Lifter, ScaledRotationsAreLargerAndPosesTheSame) {
  const torch::NoGradGuard no_grad;
  Lifter lifter(5, 8);
  lifter->Initialise(1);
  const torch::Tensor input = torch::ones({2, 15});
  const LifterOutput before = lifter->forward(input);
  lifter->ScaleRotations(16.0);  // a power of two, so that nothing is rounded
  const LifterOutput after = lifter->forward(input);
  EXPECT_TRUE(torch::equal(after.axis_angle, 16.0 * before.axis_angle));
  EXPECT_TRUE(torch::equal(after.pose, before.pose));
}

TEST(Lifter, ScalingSixNumbersLeavesTheIdentityTheyAreAddedToAsItIs) {
  const torch::NoGradGuard no_grad;
  Lifter lifter(5, 8, RotationForm::kSix);
  lifter->Initialise(1);
  Lifter scaled(5, 8, RotationForm::kSix);
  scaled->Initialise(1);
  scaled->ScaleRotations(16.0);
  for (const auto& item : lifter->named_parameters()) {
    const double factor = item.key() == "enc_rot.weight" || item.key() == "enc_rot.bias" ? 16.0 : 1.0;
    EXPECT_TRUE(torch::equal(scaled->named_parameters()[item.key()], factor * item.value())) << item.key();
  }
  const torch::Tensor input = torch::ones({2, 15});
  EXPECT_TRUE(torch::equal(scaled->forward(input).pose, lifter->forward(input).pose));
  const auto trace = [&](Lifter& of) { return of->forward(input).rotation[0].trace().item<double>(); };
  EXPECT_GT(trace(lifter), 2.0);  // near no rotation
  EXPECT_LT(trace(scaled), 2.0);
  scaled->ScaleRotations(0.0);
  EXPECT_TRUE(torch::equal(scaled->forward(input).rotation, torch::eye(3).expand({2, 3, 3})));
}

TEST(Lifter, InitialisationDependsOnTheSeedAlone) {
  Lifter a(5, 16);
  Lifter b(5, 16);
  torch::manual_seed(1);
  a->Initialise(7);
  torch::manual_seed(2);
  b->Initialise(7);
  for (const auto& item : a->named_parameters())
    EXPECT_TRUE(torch::equal(item.value(), b->named_parameters()[item.key()]));
  b->Initialise(8);
  EXPECT_FALSE(torch::equal(a->named_parameters()["upscale.weight"], b->named_parameters()["upscale.weight"]));
  const double bound = 1.0 / std::sqrt(15.0);
  EXPECT_LE(a->named_parameters()["upscale.weight"].abs().max().item<double>(), bound);
  EXPECT_GT(a->named_parameters()["upscale.weight"].abs().max().item<double>(), 0.9 * bound);
}

TEST(Lifter, SeesOfConfidencesWhatItWasMadeToSee) {
  constexpr int kJoints = 4;
  torch::Tensor sure = torch::linspace(-1.0, 1.0, 3 * kJoints).view({1, 3 * kJoints}).clone();
  sure.narrow(1, 2 * kJoints, kJoints).fill_(0.9);
  torch::Tensor unsure = sure.clone();
  unsure.narrow(1, 2 * kJoints, kJoints).fill_(0.2);
  torch::Tensor missing = sure.clone();
  missing[0][2 * kJoints + 1] = 0.0;
  const auto same = [&](ConfidenceInput confidences, const torch::Tensor& a, const torch::Tensor& b) {
    Lifter lifter(kJoints, 8, RotationForm::kAxisAngle, confidences);
    lifter->Initialise(1);
    return torch::equal(lifter->forward(a).pose, lifter->forward(b).pose);
  };
  EXPECT_FALSE(same(ConfidenceInput::kAll, sure, unsure));
  EXPECT_TRUE(same(ConfidenceInput::kMissing, sure, unsure));
  EXPECT_FALSE(same(ConfidenceInput::kMissing, sure, missing));
  EXPECT_TRUE(same(ConfidenceInput::kNone, sure, missing));
}

}  // namespace
}  // namespace canonpose
