#include "canonpose/model/martinez_lifter.h"

#include <gtest/gtest.h>

#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {

constexpr int kJoints = 5;

torch::Tensor SomeInput(int rows) { return torch::linspace(-1.0, 1.0, rows * 3 * kJoints).view({rows, 3 * kJoints}); }

MartinezLifter SomeNetwork(std::uint64_t seed) {
  MartinezLifter network(kJoints, 16);
  network->Initialise(seed);
  return network;
}

TEST(MartinezLifter, OutputsAPoseInTheCameraAndNoRotation) {
  MartinezLifter network = SomeNetwork(1);
  network->eval();
  const LifterOutput output = network->forward(SomeInput(7));
  EXPECT_EQ(output.pose.sizes(), (std::vector<std::int64_t>{7, 3, kJoints}));
  EXPECT_TRUE(torch::equal(output.rotation, torch::eye(3).expand({7, 3, 3})));
}

TEST(MartinezLifter, DoesNotSeeConfidences) {
  MartinezLifter network = SomeNetwork(1);
  network->eval();
  torch::Tensor other = SomeInput(4).clone();
  other.narrow(1, 2 * kJoints, kJoints).fill_(0.3);
  EXPECT_TRUE(torch::equal(network->forward(SomeInput(4)).pose, network->forward(other).pose));
  other.narrow(1, 0, 1).add_(0.5);
  EXPECT_FALSE(torch::equal(network->forward(SomeInput(4)).pose, network->forward(other).pose));
}

TEST(MartinezLifter, DropsOutInTrainingAlone) {
  MartinezLifter network = SomeNetwork(2);
  const auto pose = [&] { return network->forward(SomeInput(6)).pose; };
  network->train();
  torch::manual_seed(5);
  const torch::Tensor first = pose();
  const torch::Tensor second = pose();
  EXPECT_FALSE(torch::equal(first, second));
  torch::manual_seed(5);
  EXPECT_TRUE(torch::equal(first, pose()));
  network->eval();
  EXPECT_TRUE(torch::equal(pose(), pose()));
}

TEST(MartinezLifter, MirrorNegatesDepthAlone) {
  MartinezLifter network = SomeNetwork(3);
  network->eval();
  const torch::Tensor before = network->forward(SomeInput(3)).pose;
  network->Mirror();
  const torch::Tensor after = network->forward(SomeInput(3)).pose;
  EXPECT_TRUE(torch::allclose(after, before * torch::tensor({1.0F, 1.0F, -1.0F}).view({1, 3, 1})));
}

TEST(MartinezLifter, ItsFileHoldsTheStatisticsOfTraining) {
  MartinezLifter network = SomeNetwork(4);
  network->train();
  for (int step = 0; step < 5; ++step) network->forward(SomeInput(9) + 0.1 * step);
  network->eval();
  const NamedArrays arrays = ParametersOf(*network);
  EXPECT_TRUE(arrays.contains("first_norm.running_mean"));
  EXPECT_EQ(StatisticsOf(*network).size(), 10U);

  MartinezLifter read(kJoints, 16);
  LoadParameters(*read, arrays, "file");
  read->eval();
  EXPECT_TRUE(torch::equal(read->forward(SomeInput(2)).pose, network->forward(SomeInput(2)).pose));
}

}  // namespace
}  // namespace canonpose
