// The lifting network: a 2D pose becomes a canonical 3D pose and the rotation that turns it towards the camera.
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

/// Rotation matrices of rotation vectors: (B, 3) -> (B, 3, 3). R = I + sin(t) K + (1 - cos(t)) K^2 with K the
/// cross-product matrix of r / t and t^2 = max(|r|^2, 1e-4), the clamp of the published implementation.
torch::Tensor Rodrigues(const torch::Tensor& axis_angle);

/// Rotation matrices of two vectors each: (B, 6) = (a, b) -> (B, 3, 3) with columns a / |a|, the part of b across it
/// made a unit vector, and their cross product. Continuous, which no form with three numbers is: Zhou et al., "On the
/// Continuity of Rotation Representations in Neural Networks", CVPR 2019, equation 15.
torch::Tensor RotationFromSix(const torch::Tensor& six);

/// What training and lifting know of a network.
class LiftingNetwork : public torch::nn::Module {
 public:
  /// `input` is (B, 3J): x of all joints, y of all joints, confidences.
  virtual LifterOutput forward(const torch::Tensor& input) = 0;

  [[nodiscard]] int joint_count() const { return joint_count_; }

  /// Draws all parameters from our own generator: the same on every machine and version.
  virtual void Initialise(std::uint64_t seed) = 0;

  /// Multiplies the weights and the bias of the last rotation layer, where there is one: an untrained network's
  /// rotations are then as much more spread out.
  virtual void ScaleRotations(double factor) = 0;

  /// Turns the network into its depth mirror, exactly: with F = diag(1, 1, -1) every pose X becomes F X and every
  /// rotation F R F, so that each 2D reprojection stays as it is and each depth changes sign.
  void Mirror();

  /// Applies Mirror()'s signs to a tensor that belongs to the parameter `name` (an optimiser's first moment); others
  /// are untouched.
  virtual void MirrorRows(const std::string& name, torch::Tensor& tensor) const = 0;

 protected:
  LiftingNetwork(int joint_count, ConfidenceInput confidences) : joint_count_(joint_count), confidences_(confidences) {}

  /// The columns of the input as the network sees them, and how many.
  [[nodiscard]] torch::Tensor Seen(const torch::Tensor& input) const;
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

/// Fully connected to `width`, one common residual block, then a branch of two blocks for the pose and one of two for
/// the rotation. Parameter names are those of the golden files. Of the form kSix the first two columns of the identity
/// are added to what the rotation branch gives, so that either form starts near no rotation.
class LifterImpl : public LiftingNetwork {
 public:
  LifterImpl(int joint_count, int width, RotationForm form = RotationForm::kAxisAngle,
             ConfidenceInput confidences = ConfidenceInput::kAll);

  LifterOutput forward(const torch::Tensor& input) override;

  [[nodiscard]] int width() const { return width_; }

  /// Uniform in +-1/sqrt(fan in), PyTorch's default for linear layers.
  void Initialise(std::uint64_t seed) override;
  void ScaleRotations(double factor) override;

  /// Negates the z rows of the pose layer and, of the rotation layer, the x and y rows of a rotation vector or the z
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
