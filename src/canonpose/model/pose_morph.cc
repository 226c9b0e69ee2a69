#include "canonpose/model/pose_morph.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/geometry/normalisation.h"
#include "canonpose/model/morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {
constexpr std::int64_t kChunk = 4096;
}  // namespace

struct PoseMorph::State {
  std::shared_ptr<const ModelFile> model;
  torch::Device device;
  mutable Morph network;
};

PoseMorph::PoseMorph(std::unique_ptr<State> state) : state_(std::move(state)) {}
PoseMorph::~PoseMorph() = default;
PoseMorph::PoseMorph(PoseMorph&&) noexcept = default;
PoseMorph& PoseMorph::operator=(PoseMorph&&) noexcept = default;

const std::shared_ptr<const ModelFile>& PoseMorph::model() const { return state_->model; }

PoseMorph PoseMorph::Open(const std::filesystem::path& run_or_model, const std::string& device) {
  return Of(std::make_shared<const ModelFile>(ReadModelFile(run_or_model)), run_or_model.string(), device);
}

PoseMorph PoseMorph::Of(std::shared_ptr<const ModelFile> model, const std::string& file, const std::string& device) {
  RequireDevice(device);
  if (model->info.network != NetworkKind::kMorph) {
    ThrowBadInput({file, "", "a model made by `canonpose train-morph`", "a lifter",
                   "train a morphing network, or leave `morph` out"});
  }
  const torch::Device torch_device(device == "cuda" ? torch::kCUDA : torch::kCPU);
  Morph network(model->info.skeleton.joint_count(), model->info.width);
  LoadParameters(*network, model->parameters, file);
  network->to(torch_device);
  return PoseMorph(std::make_unique<State>(State{std::move(model), torch_device, std::move(network)}));
}

void PoseMorph::Apply(CameraView& view, int frame_count) const {
  const torch::NoGradGuard no_grad;
  const Skeleton& skeleton = state_->model->info.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  std::vector<int> frames;
  std::vector<float> scale_px;
  std::vector<float> input;
  const auto move_chunk = [&] {
    if (frames.empty()) return;
    const auto rows = static_cast<std::int64_t>(frames.size());
    const torch::Tensor offsets =
        state_->network->forward(torch::from_blob(input.data(), {rows, 3 * skeleton.joint_count()}).to(state_->device))
            .to(torch::kCPU)
            .contiguous();
    const float* offset = offsets.data_ptr<float>();
    for (std::size_t row = 0; row < frames.size(); ++row, offset += 2 * joints) {
      float* keypoints = &view.keypoints[2 * joints * static_cast<std::size_t>(frames[row])];
      for (std::size_t i = 0; i < 2 * joints; ++i) keypoints[i] += scale_px[row] * offset[i % 2 * joints + i / 2];
    }
    frames.clear();
    scale_px.clear();
    input.clear();
  };
  NormalisedPose pose;
  for (int t = 0; t < frame_count; ++t) {
    const std::size_t first = joints * static_cast<std::size_t>(t);
    if (!NormalisePose(&view.keypoints[2 * first], &view.confidence[first], skeleton.joint_count(), skeleton.root,
                       pose)) {
      continue;
    }
    frames.push_back(t);
    scale_px.push_back(pose.scale_px);
    input.insert(input.end(), pose.keypoints.begin(), pose.keypoints.end());
    input.insert(input.end(), pose.confidence.begin(), pose.confidence.end());
    if (static_cast<std::int64_t>(frames.size()) == kChunk) move_chunk();
  }
  move_chunk();
}

std::string PoseMorph::Describe() const {
  Fingerprint fingerprint;
  for (const auto& [name, array] : state_->model->parameters) {
    fingerprint.Add(name);
    fingerprint.Add(array.values.data(), array.values.size() * sizeof(float));
  }
  return fmt::format("the morphing network {:016x} of width {}", fingerprint.value(), state_->model->info.width);
}

void PoseMorph::Apply(Dataset& dataset, const std::string& file) const {
  const Skeleton& skeleton = state_->model->info.skeleton;
  if (!skeleton.SameJoints(dataset.skeleton)) {
    ThrowBadInput({file, "/skeleton",
                   fmt::format("the joints of the morphing network ({})", fmt::join(skeleton.joints, ", ")),
                   fmt::format("{}", fmt::join(dataset.skeleton.joints, ", ")),
                   "import the data onto its skeleton, or train a morphing network on this one"});
  }
  if (!dataset.source.morph.empty()) {
    ThrowBadInput({file, "", "keypoints as the detector wrote them",
                   fmt::format("some moved by {}", dataset.source.morph),
                   "import the data without `morph`, or leave `morph` out here"});
  }
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) Apply(view, sequence.frame_count);
  }
  dataset.source.morph = Describe();
}

}  // namespace canonpose
