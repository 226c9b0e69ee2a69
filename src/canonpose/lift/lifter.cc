#include "canonpose/lift/lifter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/geometry/normalisation.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {
constexpr std::int64_t kChunk = 4096;
}  // namespace

struct PoseLifter::State {
  ModelInfo info;
  torch::Device device;
  mutable Lifter lifter;
};

PoseLifter::PoseLifter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PoseLifter::~PoseLifter() = default;
PoseLifter::PoseLifter(PoseLifter&&) noexcept = default;

const ModelInfo& PoseLifter::info() const { return state_->info; }

PoseLifter PoseLifter::Open(const std::filesystem::path& run_or_model, const std::string& device) {
  RequireDevice(device);
  WarnAboutSlowLinearAlgebra();
  ModelFile model = ReadModelFile(run_or_model);
  const torch::Device torch_device(device == "cuda" ? torch::kCUDA : torch::kCPU);
  Lifter lifter = MakeLifter(model, run_or_model.string(), torch_device);
  return PoseLifter(std::make_unique<State>(State{std::move(model.info), torch_device, std::move(lifter)}));
}

void PoseLifter::RequireSkeleton(const Skeleton& other, const std::string& file) const {
  if (skeleton().SameJoints(other)) return;
  ThrowBadInput(
      {file, "/skeleton",
       fmt::format("the model's {} joints ({})", skeleton().joint_count(), fmt::join(skeleton().joints, ", ")),
       fmt::format("{} ({})", other.joint_count(), fmt::join(other.joints, ", ")),
       "import the data onto the model's skeleton, or use a model trained on this one"});
}

LiftedPoses PoseLifter::Lift(const CameraView& view, int frame_count) const {
  const torch::NoGradGuard no_grad;
  const int joints = skeleton().joint_count();
  const auto frames = static_cast<std::size_t>(frame_count);
  const auto joint_count = static_cast<std::size_t>(joints);
  CANONPOSE_CHECK(view.confidence.size() == frames * joint_count, "{} confidences for {} frames",
                  view.confidence.size(), frames);

  LiftedPoses lifted;
  lifted.frame_count = frame_count;
  lifted.joint_count = joints;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  lifted.pose_in_camera.assign(frames * joint_count * 3, kNan);
  lifted.canonical.assign(frames * joint_count * 3, kNan);
  lifted.rotation.assign(frames * 9, kNan);

  std::vector<float> input;  // (B, 3J)
  std::vector<std::size_t> rows;
  const auto flush = [&] {
    if (rows.empty()) return;
    const torch::Tensor batch =
        torch::from_blob(input.data(), {static_cast<std::int64_t>(rows.size()), 3 * joints}).to(state_->device);
    const LifterOutput output = state_->lifter->forward(batch);
    const torch::Tensor centred = output.pose - output.pose.narrow(2, skeleton().root, 1);  // (B, 3, J)
    const torch::Tensor canonical = centred.transpose(1, 2).to(torch::kCPU).contiguous();   // (B, J, 3)
    const torch::Tensor in_camera = torch::bmm(output.rotation, centred).transpose(1, 2).to(torch::kCPU).contiguous();
    const torch::Tensor rotation = output.rotation.to(torch::kCPU).contiguous();
    for (std::size_t b = 0; b < rows.size(); ++b) {
      std::copy_n(canonical.data_ptr<float>() + b * joint_count * 3, joint_count * 3,
                  &lifted.canonical[rows[b] * joint_count * 3]);
      std::copy_n(in_camera.data_ptr<float>() + b * joint_count * 3, joint_count * 3,
                  &lifted.pose_in_camera[rows[b] * joint_count * 3]);
      std::copy_n(rotation.data_ptr<float>() + b * 9, 9, &lifted.rotation[rows[b] * 9]);
    }
    rows.clear();
    input.clear();
  };

  NormalisedPose pose;
  for (std::size_t t = 0; t < frames; ++t) {
    if (!NormalisePose(&view.keypoints[t * joint_count * 2], &view.confidence[t * joint_count], joints, skeleton().root,
                       pose))
      continue;
    input.insert(input.end(), pose.keypoints.begin(), pose.keypoints.end());
    input.insert(input.end(), pose.confidence.begin(), pose.confidence.end());
    rows.push_back(t);
    if (static_cast<std::int64_t>(rows.size()) == kChunk) flush();
  }
  flush();
  return lifted;
}

}  // namespace canonpose
