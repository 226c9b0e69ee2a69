// The lifting network: from a 2D pose to a canonical 3D pose and the rotation that takes it into the camera's frame.
//
// Wandt et al., "CanonPose: Self-Supervised Monocular 3D Human Pose Estimation in the Wild", CVPR 2021, section 3.
#pragma once

#include <cstdint>
#include <string>

#include <torch/torch.h>

#include "canonpose/model/model_form.h"

namespace canonpose {

struct LifterOutput {
  torch::Tensor pose;        ///< (B, 3, J) canonical pose X, in the network's unit
  torch::Tensor axis_angle;  ///< (B, 3) rotation vector; undefined for the form kSix
  torch::Tensor rotation;    ///< (B, 3, 3) camera_from_canonical: pose_in_camera = rotation * pose
};

/// Rotation matrices of rotation vectors r: (B, 3) -> (B, 3, 3). R = I + sin(t) K + (1 - cos(t)) K^2 with K the
/// cross-product matrix of r / t and t^2 = max(|r|^2, 1e-4), as the published implementation clamps it.
torch::Tensor Rodrigues(const torch::Tensor& axis_angle);

/// Rotation matrices of pairs of vectors: (B, 6) = (a, b) -> (B, 3, 3). The columns are a / |a|, the normalised part of
/// b that is orthogonal to a, and their cross product. Unlike any form with three numbers it is continuous: Zhou et
/// al., "On the Continuity of Rotation Representations in Neural Networks", CVPR 2019, equation 15.
torch::Tensor RotationFromSix(const torch::Tensor& six);

/// What training and lifting need to know about a lifter.
class LiftingNetwork : public torch::nn::Module {
 public:
  /// `input` is (B, 3J): x of all joints, y of all joints, confidences.
  virtual LifterOutput forward(const torch::Tensor& input) = 0;

  [[nodiscard]] int joint_count() const { return joint_count_; }

  /// Draws all parameters with our own generator: the same numbers on every machine and version.
  virtual void Initialise(std::uint64_t seed) = 0;

  /// Multiplies the weights and the bias of the last rotation layer, so that an untrained network's rotations are
  /// spread out by that factor.
  virtual void ScaleRotations(double factor) = 0;

  /// Turns the network into its mirror image in depth, exactly: with F = diag(1, 1, -1) every pose X becomes F X and
  /// every rotation R becomes F R F, so that each reprojection stays the same and each depth changes its sign.
  void Mirror();

  /// Applies the sign changes of Mirror() to a tensor shaped like the parameter `name`, such as an optimiser's first
  /// moment.
  virtual void MirrorRows(const std::string& name, torch::Tensor& tensor) const = 0;

 protected:
  LiftingNetwork(int joint_count, ConfidenceInput confidences) : joint_count_(joint_count), confidences_(confidences) {}

  /// The part of the input that the network sees, in the form in which it sees it.
  [[nodiscard]] torch::Tensor Seen(const torch::Tensor& input) const;
  /// The number of its columns.
  [[nodiscard]] std::int64_t input_size() const {
    return (confidences_ == ConfidenceInput::kNone ? 2 : 3) * joint_count_;
  }

 private:
  int joint_count_;
  ConfidenceInput confidences_;
};

/// x + lrelu(l2(lrelu(l1(x)))), then one more leaky ReLU; slope 0.01.
class ResidualBlockImpl : public torch::nn::Module {
 public:
  explicit ResidualBlockImpl(int width);
  torch::Tensor forward(const torch::Tensor& x);

 private:
  torch::nn::Linear l1_;
  torch::nn::Linear l2_;
};
TORCH_MODULE(ResidualBlock);

/// A linear layer to `width`, one common residual block, then two branches of two blocks and a linear layer each, for
/// the pose and for the rotation. Parameter names are those of the golden files. With kSix the first two columns of the
/// identity are added to the output of the rotation branch, so that both forms start near the identity.
class LifterImpl : public LiftingNetwork {
 public:
  LifterImpl(int joint_count, int width, RotationForm form = RotationForm::kAxisAngle,
             ConfidenceInput confidences = ConfidenceInput::kAll);

  LifterOutput forward(const torch::Tensor& input) override;

  [[nodiscard]] int width() const { return width_; }

  /// Uniform in +-1/sqrt(fan in), PyTorch's default for linear layers.
  void Initialise(std::uint64_t seed) override;
  void ScaleRotations(double factor) override;

  /// Negates the z rows of the pose layer and, in the rotation layer, the x and y rows of a rotation vector or the z
  /// rows of the two columns.
  void MirrorRows(const std::string& name, torch::Tensor& tensor) const override;

 private:
  int width_;
  RotationForm form_;
  torch::nn::Linear upscale_;
  ResidualBlock res_common_;
  ResidualBlock res_pose1_;
  ResidualBlock res_pose2_;
  ResidualBlock res_cam1_;
  ResidualBlock res_cam2_;
  torch::nn::Linear pose3d_;
  torch::nn::Linear enc_rot_;
};
TORCH_MODULE(Lifter);

}  // namespace canonpose
