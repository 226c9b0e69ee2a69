#include "canonpose/train/losses.h"

#include <map>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

const torch::TensorOptions kDouble(torch::kFloat64);

std::vector<std::size_t> Reversed(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.rbegin(), order.rend(), std::size_t{0});
  return order;
}

TrainingFrame Frame(int capture, const std::vector<int>& cameras) {
  TrainingFrame frame{capture, 0, {}};
  for (const int camera : cameras) frame.views.push_back({camera, 0});
  return frame;
}

std::vector<const TrainingFrame*> Pointers(const std::vector<TrainingFrame>& frames) {
  std::vector<const TrainingFrame*> pointers;
  for (const TrainingFrame& frame : frames) pointers.push_back(&frame);
  return pointers;
}

double Sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// A random batch and a random network.
struct Example {
  explicit Example(const std::vector<TrainingFrame>& training_frames, int joints = 6, int root = 0)
      : frames(training_frames), lifter(joints, 16) {
    torch::manual_seed(1);
    lifter->Initialise(2);
    lifter->to(torch::kFloat64);
    std::int64_t rows = 0;
    for (const TrainingFrame& frame : frames) rows += static_cast<std::int64_t>(frame.views.size());
    batch.keypoints = torch::randn({rows, 2, joints}, kDouble);
    batch.keypoints = batch.keypoints - batch.keypoints.narrow(2, root, 1);
    batch.confidence = 0.1 + 0.9 * torch::rand({rows, joints}, kDouble);
  }
  Losses Compute(const torch::Tensor& perspective = {}) {
    const BatchPairs pairs = MakeBatchPairs(Pointers(frames), {1, 1}, true, Reversed);
    return ComputeLosses(lifter->forward(LifterInput(batch)), batch, pairs, LossWeights{}, perspective, 0, consistency);
  }
  Consistency consistency = Consistency::kMixing;
  std::vector<TrainingFrame> frames;
  Lifter lifter;
  BatchTensors batch;
};

TEST(MakeBatchPairs, FullFramesGiveThePublishedWeights) {
  const std::vector<TrainingFrame> frames(3, Frame(0, {0, 1, 2, 3}));
  const BatchPairs pairs = MakeBatchPairs(Pointers(frames), {1}, true, Reversed);
  EXPECT_EQ(pairs.reprojection.size(), 12U);
  EXPECT_NEAR(Sum(pairs.reprojection.weight), 1.0, 1e-12);
  EXPECT_EQ(pairs.view.size(), 3U * 4 * 3);
  EXPECT_NEAR(Sum(pairs.view.weight), 4.0, 1e-12);  // sum over source views of means
  EXPECT_EQ(pairs.camera.size(), 3U * 4 * 3);
  EXPECT_NEAR(Sum(pairs.camera.weight), 4.0, 1e-12);
}

TEST(MakeBatchPairs, ViewPairsStayWithinAFrame) {
  const std::vector<TrainingFrame> frames = {Frame(0, {0, 1}), Frame(0, {0, 1, 2}), Frame(0, {2, 1})};
  const std::vector<int> frame_of_row = {0, 0, 1, 1, 1, 2, 2};
  const PairList pairs = MakeBatchPairs(Pointers(frames), {1}, false, nullptr).view;
  EXPECT_EQ(pairs.size(), 2U + 6U + 2U);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    EXPECT_EQ(frame_of_row[pairs.source[p]], frame_of_row[pairs.target[p]]);
    EXPECT_NE(pairs.source[p], pairs.target[p]);
  }
}

TEST(MakeBatchPairs, CameraPairsUseTheSameCamerasOfAnotherFrameOfTheCapture) {
  // Rows: frame 0 (capture 0): 0, 1, 2; frame 1 (capture 1): 3, 4; frame 2 (capture 0, camera 1 missed the person):
  // 5, 6.
  const std::vector<TrainingFrame> frames = {Frame(0, {0, 1, 2}), Frame(1, {0, 1}), Frame(0, {0, 2})};
  const std::vector<int> camera_of_row = {0, 1, 2, 0, 1, 0, 2};
  const std::vector<int> frame_of_row = {0, 0, 0, 1, 1, 2, 2};
  const PairList pairs = MakeBatchPairs(Pointers(frames), {1, 1}, true, Reversed).camera;
  ASSERT_GT(pairs.size(), 0U);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    EXPECT_EQ(camera_of_row[pairs.from[p]], camera_of_row[pairs.source[p]]);
    EXPECT_EQ(camera_of_row[pairs.to[p]], camera_of_row[pairs.target[p]]);
    EXPECT_EQ(frame_of_row[pairs.from[p]], frame_of_row[pairs.to[p]]);
    EXPECT_EQ(frame_of_row[pairs.source[p]], frame_of_row[pairs.target[p]]);
    EXPECT_NE(frame_of_row[pairs.source[p]], 1);                            // capture 1 has one frame only
    EXPECT_NE(frame_of_row[pairs.from[p]], frame_of_row[pairs.source[p]]);  // two frames, reversed
  }
}

TEST(MakeBatchPairs, MovingCapturesHaveNoCameraPairs) {
  const std::vector<TrainingFrame> frames(3, Frame(0, {0, 1}));
  EXPECT_EQ(MakeBatchPairs(Pointers(frames), {0}, true, Reversed).camera.size(), 0U);
}

class LossesOf : public ::testing::TestWithParam<Consistency> {};

INSTANTIATE_TEST_SUITE_P(Losses, LossesOf,
                         ::testing::Values(Consistency::kMixing, Consistency::kEqualPoses, Consistency::kEqualCameras));

TEST_P(LossesOf, GradientsMatchNumericOnes) {
  Example example({Frame(0, {0, 1, 2}), Frame(0, {0, 2}), Frame(1, {0, 1}), Frame(0, {0, 1, 2})});
  example.consistency = GetParam();
  torch::Tensor perspective = torch::tensor(0.4, kDouble).requires_grad_();
  example.batch.confidence[0][2] = 0.0;
  example.batch.keypoints.index_put_({0, torch::indexing::Slice(), 2}, 0.0);
  example.Compute(perspective).total.backward();
  const auto check = [&](const std::string& name, const torch::Tensor& parameter) {
    torch::Tensor flat = parameter.detach().view({-1});
    const torch::Tensor gradient = parameter.grad().view({-1});
    for (const std::int64_t index : {std::int64_t{0}, flat.numel() / 2, flat.numel() - 1}) {
      constexpr double kStep = 1e-6;
      const double original = flat[index].item<double>();
      flat[index] = original + kStep;
      const double above = example.Compute(perspective).total.item<double>();
      flat[index] = original - kStep;
      const double below = example.Compute(perspective).total.item<double>();
      flat[index] = original;
      EXPECT_NEAR(gradient[index].item<double>(), (above - below) / (2 * kStep), 1e-7) << name << "[" << index << "]";
    }
  };
  for (const auto& item : example.lifter->named_parameters()) check(item.key(), item.value());
  check("perspective", perspective);
}

TEST(Losses, EqualPosesAreThoseOfOneFrameAndEqualCamerasThoseOfTwoFrames) {
  Example example({Frame(0, {0, 1}), Frame(0, {0, 1})});
  LifterOutput output = example.lifter->forward(LifterInput(example.batch));
  const BatchPairs pairs = MakeBatchPairs(Pointers(example.frames), {1}, true, Reversed);
  const auto losses = [&](Consistency consistency) {
    return ComputeLosses(output, example.batch, pairs, {}, {}, 0, consistency);
  };
  EXPECT_GT(losses(Consistency::kEqualPoses).view.item<double>(), 1e-3);
  EXPECT_GT(losses(Consistency::kEqualCameras).camera.item<double>(), 1e-6);
  // Rows 0, 1 are a frame and 2, 3 another: poses equal within each, relative rotations equal between them.
  output.pose = output.pose.index_select(0, torch::tensor({0, 0, 2, 2}));
  const torch::Tensor turn = output.rotation[2];
  output.rotation = torch::stack({output.rotation[0], output.rotation[1], torch::mm(output.rotation[0], turn),
                                  torch::mm(output.rotation[1], turn)});
  EXPECT_NEAR(losses(Consistency::kEqualPoses).view.item<double>(), 0.0, 1e-12);
  EXPECT_NEAR(losses(Consistency::kEqualCameras).camera.item<double>(), 0.0, 1e-12);
  EXPECT_GT(losses(Consistency::kMixing).camera.item<double>(), 1e-3);
}

TEST(Losses, JointsThatAreSeenCountAlikeWhereConfidencesAreLeftOut) {
  Example example({Frame(0, {0, 1})});
  example.batch.confidence.select(1, 3).zero_();
  WeighSeenJointsAlike(example.batch);
  EXPECT_EQ(example.batch.confidence.min().item<double>(), 0.0);
  EXPECT_EQ(example.batch.confidence.sum().item<double>(), 2.0 * 5);
}

TEST(Losses, AreTheSameForTheDepthMirrorWithoutPerspectiveAndDifferWithIt) {
  Example example({Frame(0, {0, 1, 2}), Frame(0, {0, 1, 2})});
  const torch::Tensor perspective = torch::tensor(0.4, kDouble);
  const double weak = example.Compute().total.item<double>();
  const double strong = example.Compute(perspective).total.item<double>();
  const double inverse = example.Compute(-perspective).total.item<double>();
  example.lifter->Mirror();
  EXPECT_NEAR(example.Compute().total.item<double>(), weak, 1e-12);
  EXPECT_NEAR(example.Compute(-perspective).total.item<double>(), strong, 1e-12);
  EXPECT_NEAR(example.Compute(perspective).total.item<double>(), inverse, 1e-12);
  EXPECT_GT(std::abs(strong - inverse), 1e-4);
}

TEST(Losses, DoNotDependOnTheScaleOfKeypoints) {
  Example example({Frame(0, {0, 1})});
  const LifterOutput output = example.lifter->forward(LifterInput(example.batch));
  const BatchPairs pairs = MakeBatchPairs(Pointers(example.frames), {1, 1}, true, Reversed);
  const double before = ComputeLosses(output, example.batch, pairs, {}, {}, 0).total.item<double>();
  example.batch.keypoints = example.batch.keypoints * 7.0;
  EXPECT_NEAR(ComputeLosses(output, example.batch, pairs, {}, {}, 0).total.item<double>(), before, 1e-12);
}

TEST(Losses, WhatIsNotSeenDoesNotMatter) {
  Example example({Frame(0, {0, 1}), Frame(0, {0, 1})});
  example.batch.confidence.select(1, 3).zero_();
  const LifterOutput output = example.lifter->forward(LifterInput(example.batch));
  const BatchPairs pairs = MakeBatchPairs(Pointers(example.frames), {1, 1}, true, Reversed);
  const double before = ComputeLosses(output, example.batch, pairs, {}, {}, 0).total.item<double>();
  LifterOutput moved = output;
  moved.pose = output.pose.clone();
  moved.pose.select(2, 3).add_(100.0);
  EXPECT_NEAR(ComputeLosses(moved, example.batch, pairs, {}, {}, 0).total.item<double>(), before, 1e-12);
}

TEST(Losses, AreZeroForPosesThatProjectOntoTheKeypoints) {
  // One body seen by two cameras, in two frames; the output is the truth.
  torch::manual_seed(3);
  LifterOutput output;
  const torch::Tensor body = torch::randn({2, 3, 6}, kDouble);
  output.pose = body.repeat_interleave(2, 0);                                    // frames 0, 0, 1, 1
  output.rotation = Rodrigues(torch::randn({2, 3}, kDouble)).repeat({2, 1, 1});  // cameras 0, 1, 0, 1
  BatchTensors batch;
  batch.keypoints = torch::bmm(output.rotation, output.pose).narrow(1, 0, 2);
  batch.confidence = torch::ones({4, 6}, kDouble);
  const std::vector<TrainingFrame> frames(2, Frame(0, {0, 1}));
  const BatchPairs pairs = MakeBatchPairs(Pointers(frames), {1}, true, Reversed);
  const Losses losses = ComputeLosses(output, batch, pairs, {}, {}, 0);
  EXPECT_NEAR(losses.total.item<double>(), 0.0, 1e-12);
  // And with perspective, for keypoints made with it.
  const torch::Tensor k = torch::tensor(0.5, kDouble);
  EXPECT_GT(ComputeLosses(output, batch, pairs, {}, k, 0).total.item<double>(), 0.01);
  batch.keypoints = Project(torch::bmm(output.rotation, output.pose), k, 0);
  EXPECT_NEAR(ComputeLosses(output, batch, pairs, {}, k, 0).total.item<double>(), 0.0, 1e-12);
}

TEST(SupervisedLoss, GradientsMatchNumericOnesAndUnknownTruthTakesNoPart) {
  Example example({Frame(0, {0, 1, 2}), Frame(0, {0, 2})});
  const std::int64_t rows = example.batch.keypoints.size(0);
  const std::int64_t joints = example.batch.keypoints.size(2);
  torch::manual_seed(5);
  torch::Tensor truth = torch::randn({rows, 3, joints}, kDouble);
  truth = truth - truth.narrow(2, 0, 1);
  truth[1].select(1, 2).fill_(std::numeric_limits<double>::quiet_NaN());
  const torch::Tensor squares = torch::nan_to_num(truth).square().sum({1, 2}, true);
  example.batch.target = truth / squares.sqrt();
  const auto loss = [&] {
    return ComputeSupervisedLoss(example.lifter->forward(LifterInput(example.batch)), example.batch, 0).total;
  };
  loss().backward();
  for (const auto& item : example.lifter->named_parameters()) {
    torch::Tensor flat = item.value().detach().view({-1});
    const std::int64_t index = flat.numel() / 2;
    constexpr double kStep = 1e-6;
    const double original = flat[index].item<double>();
    flat[index] = original + kStep;
    const double above = loss().item<double>();
    flat[index] = original - kStep;
    const double below = loss().item<double>();
    flat[index] = original;
    EXPECT_NEAR(item.value().grad().view({-1})[index].item<double>(), (above - below) / (2 * kStep), 1e-7)
        << item.key();
  }
}

TEST(SupervisedLoss, WeightsScaleWhatAJointCounts) {
  torch::manual_seed(7);
  BatchTensors batch;
  torch::Tensor target = torch::randn({3, 3, 6}, kDouble);
  target = target - target.narrow(2, 0, 1);
  batch.target = target / target.square().sum({1, 2}, true).sqrt();
  LifterOutput output;
  output.rotation = torch::eye(3, kDouble).expand({3, 3, 3});
  output.pose = torch::randn({3, 3, 6}, kDouble);
  const double plain = ComputeSupervisedLoss(output, batch, 0).total.item<double>();
  batch.target_weight = torch::full({3, 6}, 0.3, kDouble);
  EXPECT_NEAR(ComputeSupervisedLoss(output, batch, 0).total.item<double>(), plain, 1e-12);
  // Only one joint of one pose counts: the loss is its distance.
  batch.target_weight.zero_();
  batch.target_weight[1][4] = 0.7;
  torch::Tensor pose = output.pose[1] - output.pose[1].narrow(1, 0, 1);
  pose = pose / pose.norm();
  const double distance = (pose.select(1, 4) - batch.target[1].select(1, 4)).norm().item<double>();
  EXPECT_NEAR(ComputeSupervisedLoss(output, batch, 0).total.item<double>(), distance, 1e-9);
}

TEST(SupervisedLoss, IsZeroForTheTruthAtAnyScaleAndPlaceAndNotForItsMirror) {
  torch::manual_seed(6);
  torch::Tensor truth = torch::randn({4, 3, 6}, kDouble);
  truth = truth - truth.narrow(2, 0, 1);
  truth = truth / truth.square().sum({1, 2}, true).sqrt();
  BatchTensors batch;
  batch.target = truth.clone();
  batch.target[2].select(1, 5).fill_(std::numeric_limits<double>::quiet_NaN());
  batch.target[2] /= torch::nan_to_num(batch.target[2]).square().sum().sqrt();
  LifterOutput output;
  output.rotation = Rodrigues(torch::randn({4, 3}, kDouble));
  output.pose = torch::bmm(output.rotation.transpose(1, 2), 7.0 * truth + 3.0);
  EXPECT_NEAR(ComputeSupervisedLoss(output, batch, 0).total.item<double>(), 0.0, 2e-6);
  output.pose =
      torch::bmm(output.rotation.transpose(1, 2), truth * torch::tensor({1.0, 1.0, -1.0}, kDouble).view({3, 1}));
  EXPECT_GT(ComputeSupervisedLoss(output, batch, 0).total.item<double>(), 0.1);
}

TEST(Project, NearPartsLookLarger) {
  // Root at the origin, one joint nearer and one farther, at the same offset.
  const torch::Tensor pose = torch::tensor({{{0.0, 1.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, -1.0, 1.0}}}, kDouble);
  const torch::Tensor projected = Project(pose, torch::tensor(0.5, kDouble), 0);
  EXPECT_GT(projected[0][0][1].item<double>(), 1.0);
  EXPECT_LT(projected[0][0][2].item<double>(), 1.0);
  EXPECT_NEAR(projected[0][0][1].item<double>(), 1.0 / (1.0 - 0.5 / 2.0), 1e-12);  // the pose's norm is 2
}

}  // namespace
}  // namespace canonpose
