#include "canonpose/model/lifter.h"

#include <cmath>

#include "canonpose/model/uniform_initialisation.h"

namespace canonpose {
namespace {

constexpr double kLeakySlope = 0.01;
constexpr double kSmallestSquaredAngle = 1e-4;
constexpr double kSmallestSquaredLength = 1e-12;

/// In place, which halves the memory traffic of small layers; no layer needs its output from before the activation.
torch::Tensor LeakyRelu(torch::Tensor x) { return torch::leaky_relu_(x, kLeakySlope); }

/// (B, 3) -> (B, 3) of length 1.
torch::Tensor Unit(const torch::Tensor& vectors) {
  return vectors / torch::sqrt(torch::clamp_min((vectors * vectors).sum(1, /*keepdim=*/true), kSmallestSquaredLength));
}

}  // namespace

torch::Tensor Rodrigues(const torch::Tensor& axis_angle) {
  const torch::Tensor angle = torch::sqrt(
      torch::clamp_min((axis_angle * axis_angle).sum(1, /*keepdim=*/true), kSmallestSquaredAngle));  // (B, 1)
  const torch::Tensor axis = axis_angle / angle;                                                     // (B, 3)
  const std::vector<torch::Tensor> xyz = axis.unbind(1);
  const torch::Tensor zero = torch::zeros_like(xyz[0]);
  const torch::Tensor cross =
      torch::stack({zero, -xyz[2], xyz[1], xyz[2], zero, -xyz[0], -xyz[1], xyz[0], zero}, 1).view({-1, 3, 3});
  const torch::Tensor sine = torch::sin(angle).unsqueeze(2);
  const torch::Tensor versine = (1 - torch::cos(angle)).unsqueeze(2);
  return torch::eye(3, axis_angle.options()) + sine * cross + versine * torch::bmm(cross, cross);
}

torch::Tensor RotationFromSix(const torch::Tensor& six) {
  const torch::Tensor first = Unit(six.narrow(1, 0, 3));  // (B, 3)
  const torch::Tensor b = six.narrow(1, 3, 3);
  const torch::Tensor second = Unit(b - (first * b).sum(1, /*keepdim=*/true) * first);
  return torch::stack({first, second, torch::cross(first, second, 1)}, 2);
}

ResidualBlockImpl::ResidualBlockImpl(int width)
    : l1_(register_module("l1", torch::nn::Linear(width, width))),
      l2_(register_module("l2", torch::nn::Linear(width, width))) {}

torch::Tensor ResidualBlockImpl::forward(const torch::Tensor& x) {
  return LeakyRelu(x + LeakyRelu(l2_(LeakyRelu(l1_(x)))));
}

void LiftingNetwork::Mirror() {
  for (const auto& item : named_parameters()) {
    torch::Tensor parameter = item.value();
    MirrorRows(item.key(), parameter);
  }
}

torch::Tensor LiftingNetwork::Seen(const torch::Tensor& input) const {
  if (confidences_ == ConfidenceInput::kAll) return input;
  torch::Tensor points = input.narrow(1, 0, 2 * joint_count_);  // of norm 1, see NormalisePose()
  if (confidences_ == ConfidenceInput::kNone) return points;
  const torch::Tensor seen = (input.narrow(1, 2 * joint_count_, joint_count_) > 0).to(input.scalar_type());
  return torch::cat({std::sqrt(2.0 * joint_count_) * points, seen - 1}, 1);
}

LifterImpl::LifterImpl(int joint_count, int width, RotationForm form, ConfidenceInput confidences)
    : LiftingNetwork(joint_count, confidences),
      width_(width),
      form_(form),
      upscale_(register_module("upscale", torch::nn::Linear(input_size(), width))),
      res_common_(register_module("res_common", ResidualBlock(width))),
      res_pose1_(register_module("res_pose1", ResidualBlock(width))),
      res_pose2_(register_module("res_pose2", ResidualBlock(width))),
      res_cam1_(register_module("res_cam1", ResidualBlock(width))),
      res_cam2_(register_module("res_cam2", ResidualBlock(width))),
      pose3d_(register_module("pose3d", torch::nn::Linear(width, 3 * joint_count))),
      enc_rot_(register_module("enc_rot", torch::nn::Linear(width, form == RotationForm::kSix ? 6 : 3))) {}

LifterOutput LifterImpl::forward(const torch::Tensor& input) {
  const torch::Tensor common = res_common_(upscale_(Seen(input)));
  LifterOutput output;
  output.pose = pose3d_(res_pose2_(res_pose1_(common))).view({-1, 3, joint_count()});
  const torch::Tensor encoded = enc_rot_(res_cam2_(res_cam1_(common)));
  if (form_ == RotationForm::kSix) {
    output.rotation = RotationFromSix(encoded + torch::eye(3, encoded.options()).narrow(0, 0, 2).flatten());
    return output;
  }
  output.axis_angle = encoded;
  output.rotation = Rodrigues(output.axis_angle);
  return output;
}

void LifterImpl::Initialise(std::uint64_t seed) { InitialiseUniformly(*this, seed); }

void LifterImpl::ScaleRotations(double factor) {
  const torch::NoGradGuard no_grad;
  enc_rot_->weight.mul_(factor);
  enc_rot_->bias.mul_(factor);
}

void LifterImpl::MirrorRows(const std::string& name, torch::Tensor& tensor) const {
  const torch::NoGradGuard no_grad;
  const int joints = joint_count();
  if (name == "pose3d.weight" || name == "pose3d.bias") tensor.narrow(0, 2 * joints, joints).neg_();
  if (name != "enc_rot.weight" && name != "enc_rot.bias") return;
  if (form_ == RotationForm::kAxisAngle) {
    // F R(w) F = R(-w_x, -w_y, w_z): a rotation vector is axial.
    tensor.narrow(0, 0, 2).neg_();
    return;
  }
  // The first two columns of F R F are F times those of R, and the third, their cross product, follows.
  tensor.select(0, 2).neg_();
  tensor.select(0, 5).neg_();
}

}  // namespace canonpose
