// The lifting network: a 2D pose becomes a canonical 3D pose and the rotation that turns it towards the camera.
//
// Wandt et al., "CanonPose: Self-Supervised Monocular 3D Human Pose Estimation in the Wild", CVPR 2021, section 3.
#pragma once

#include <cstdint>
#include <string>

#include <torch/torch.h>

namespace canonpose {

struct LifterOutput {
  torch::Tensor pose;        ///< (B, 3, J) canonical pose X, in the network's unit
  torch::Tensor axis_angle;  ///< (B, 3) rotation vector
  torch::Tensor rotation;    ///< (B, 3, 3) camera_from_canonical: pose_in_camera = rotation * pose
};

/// Rotation matrices of rotation vectors: (B, 3) -> (B, 3, 3). R = I + sin(t) K + (1 - cos(t)) K^2 with K the
/// cross-product matrix of r / t and t^2 = max(|r|^2, 1e-4), the clamp of the published implementation.
torch::Tensor Rodrigues(const torch::Tensor& axis_angle);

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

/// Input (B, 3J): x of all joints, y of all joints, confidences. Fully connected to `width`, one common residual block,
/// then a branch of two blocks for the pose and one of two for the rotation. Parameter names are those of the golden
/// files.
class LifterImpl : public torch::nn::Module {
 public:
  LifterImpl(int joint_count, int width);

  LifterOutput forward(const torch::Tensor& input);

  [[nodiscard]] int joint_count() const { return joint_count_; }
  [[nodiscard]] int width() const { return width_; }

  /// Uniform in +-1/sqrt(fan in) (PyTorch's default for linear layers), from our own generator: the same on every
  /// machine and version.
  void Initialise(std::uint64_t seed);

  /// Multiplies the weights and the bias of the last rotation layer: an untrained network's rotations are then as much
  /// more spread out.
  void ScaleRotations(double factor);

  /// Turns the network into its depth mirror, exactly: with F = diag(1, 1, -1) every pose X becomes F X and every
  /// rotation F R F, so that each 2D reprojection stays as it is and each depth changes sign. Negates the z rows of the
  /// pose layer and the x and y rows of the rotation layer.
  void Mirror();

  /// Applies Mirror()'s signs to a tensor that belongs to the parameter `name` (an optimiser's first moment); others
  /// are untouched.
  void MirrorRows(const std::string& name, torch::Tensor& tensor) const;

 private:
  int joint_count_;
  int width_;
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
