// The field's supervised baseline: a network whose only output is the pose in the camera.
//
// Martinez et al., "A simple yet effective baseline for 3d human pose estimation", ICCV 2017, section 3.2.
#pragma once

#include "canonpose/model/lifter.h"

namespace canonpose {

/// x + f2(f1(x)) with f = dropout of one half after ReLU after batch normalisation after a linear layer.
class MartinezBlockImpl : public torch::nn::Module {
 public:
  explicit MartinezBlockImpl(int width);
  torch::Tensor forward(const torch::Tensor& x);

 private:
  torch::nn::Linear l1_;
  torch::nn::BatchNorm1d n1_;
  torch::nn::Linear l2_;
  torch::nn::BatchNorm1d n2_;
};
TORCH_MODULE(MartinezBlock);

/// As published: 2D coordinates, without confidences, go through one layer like those of the blocks, two blocks of
/// `width` and a linear layer. Its rotation is always the identity. Dropout draws from LibTorch's own generator.
class MartinezLifterImpl : public LiftingNetwork {
 public:
  MartinezLifterImpl(int joint_count, int width);

  LifterOutput forward(const torch::Tensor& input) override;

  /// As He et al. (ICCV 2015): weights are normal with variance 2 / fan in, biases 0, batch normalisation the identity.
  void Initialise(std::uint64_t seed) override;
  /// Must not be called: there are no rotations.
  void ScaleRotations(double factor) override;
  /// Negates the z rows of the last layer.
  void MirrorRows(const std::string& name, torch::Tensor& tensor) const override;

 private:
  torch::nn::Linear first_;
  torch::nn::BatchNorm1d first_norm_;
  MartinezBlock block1_;
  MartinezBlock block2_;
  torch::nn::Linear pose3d_;
};
TORCH_MODULE(MartinezLifter);

}  // namespace canonpose
