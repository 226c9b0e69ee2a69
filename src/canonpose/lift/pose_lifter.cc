#include "canonpose/lift/pose_lifter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/model/pose_input.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/model/runtime.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {
constexpr std::int64_t kChunk = 4096;
}  // namespace

struct PoseLifter::State {
  ModelInfo info;
  torch::Device device;
  std::shared_ptr<LiftingNetwork> network;
  std::optional<PoseMorph> morph;  ///< what poses go through before
};

PoseLifter::PoseLifter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PoseLifter::~PoseLifter() = default;
PoseLifter::PoseLifter(PoseLifter&&) noexcept = default;

const ModelInfo& PoseLifter::info() const { return state_->info; }

PoseLifter PoseLifter::Open(const std::filesystem::path& run_or_model, const std::string& device) {
  RequireDevice(device);
  return Of(ReadModelFile(run_or_model), run_or_model.string(), device);
}

PoseLifter PoseLifter::Of(ModelFile model, const std::string& name, const std::string& device) {
  RequireDevice(device);
  WarnAboutSlowLinearAlgebra();
  const torch::Device torch_device(device == "cuda" ? torch::kCUDA : torch::kCPU);
  std::shared_ptr<LiftingNetwork> network = MakeLifter(model, name, torch_device);
  std::optional<PoseMorph> morph;
  if (model.info.morph) morph = PoseMorph::Of(model.info.morph, name, device);
  return PoseLifter(
      std::make_unique<State>(State{std::move(model.info), torch_device, std::move(network), std::move(morph)}));
}

void PoseLifter::RequireImageSize(const CameraView& view, const std::string& file) const {
  if (!PoseInput(info().input, skeleton()).LacksCamera(view)) return;
  ThrowBadInput({file, "", "the image size, which this model needs: it corrects for the direction a person is seen in",
                 "none in the file", "give `image_size` WxH"});
}

void PoseLifter::RequireSkeleton(const Skeleton& other, const std::string& file) const {
  if (skeleton().SameJoints(other)) return;
  ThrowBadInput(
      {file, "/skeleton",
       fmt::format("the model's {} joints ({})", skeleton().joint_count(), fmt::join(skeleton().joints, ", ")),
       fmt::format("{} ({})", other.joint_count(), fmt::join(other.joints, ", ")),
       "import the data onto the model's skeleton, or use a model trained on this one"});
}

namespace {

/// Frames that go through the network together.
class LiftBatch {
 public:
  explicit LiftBatch(bool turns) : turns_(turns) {}

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(frames_.size()); }

  void Add(std::size_t frame, const NormalisedPose& pose, const Eigen::Matrix3d& turned_from_camera) {
    frames_.push_back(frame);
    input_.insert(input_.end(), pose.keypoints.begin(), pose.keypoints.end());
    input_.insert(input_.end(), pose.confidence.begin(), pose.confidence.end());
    // Eigen stores columns, LibTorch rows: this is the transpose, the inverse rotation.
    for (Eigen::Index i = 0; i < 9; ++i) {
      camera_from_turned_.push_back(static_cast<float>(turned_from_camera.data()[i]));
    }
  }

  /// Lifts the frames that were added, writes them to their places, and empties the batch.
  void Lift(LiftingNetwork& network, int root, torch::Device device, LiftedPoses& lifted) {
    if (frames_.empty()) return;
    const std::size_t joints = lifted.skeleton().joints.size();
    const torch::Tensor input = torch::from_blob(input_.data(), {size(), 3 * lifted.joint_count()}).to(device);
    const LifterOutput output = network.forward(input);
    torch::Tensor rotation = output.rotation;  // (B, 3, 3)
    if (turns_)
      rotation = torch::bmm(torch::from_blob(camera_from_turned_.data(), {size(), 3, 3}).to(device), rotation);
    const torch::Tensor centred = output.pose - output.pose.narrow(2, root, 1);  // (B, 3, J)
    CopyRows(centred.transpose(1, 2), joints * 3, lifted.canonical.positions());
    CopyRows(torch::bmm(rotation, centred).transpose(1, 2), joints * 3, lifted.pose_in_camera.positions());
    CopyRows(rotation, 9, lifted.rotation);
    frames_.clear();
    input_.clear();
    camera_from_turned_.clear();
  }

 private:
  void CopyRows(const torch::Tensor& rows, std::size_t row_size, std::vector<float>& to) const {
    const torch::Tensor contiguous = rows.to(torch::kCPU).contiguous();
    const float* values = contiguous.data_ptr<float>();
    for (std::size_t b = 0; b < frames_.size(); ++b) {
      std::copy_n(values + b * row_size, row_size, &to[frames_[b] * row_size]);
    }
  }

  bool turns_;
  std::vector<std::size_t> frames_;
  std::vector<float> input_;               // (B, 3J)
  std::vector<float> camera_from_turned_;  // (B, 3, 3)
};

}  // namespace

LiftedPoses PoseLifter::Lift(const CameraView& view, int frame_count) const {
  const std::optional<PoseMorph>& morph = state_->morph;
  if (!morph) return LiftMorphed(view, frame_count);
  CameraView morphed = view;
  morph->Apply(morphed, frame_count);
  return LiftMorphed(morphed, frame_count);
}

LiftedPoses PoseLifter::LiftMorphed(const CameraView& view, int frame_count) const {
  const torch::NoGradGuard no_grad;
  const auto frames = static_cast<std::size_t>(frame_count);
  const auto joints = static_cast<std::size_t>(skeleton().joint_count());
  CANONPOSE_CHECK(view.confidence.size() == frames * joints, "{} confidences for {} frames", view.confidence.size(),
                  frames);

  LiftedPoses lifted(skeleton(), frame_count, view.name);

  const PoseInput pose_input(info().input, skeleton());
  if (pose_input.LacksCamera(view)) {
    LogWarning(
        "{}: this model needs the image size to correct for the direction a person is seen in; without it, 3D poses "
        "away from the image centre come out tilted: give `image_size`",
        view.name.empty() ? "this view" : view.name);
  }
  LiftBatch batch(info().input.ray != RayForm::kOff);
  NormalisedPose pose;
  Eigen::Matrix3d turned_from_camera;
  for (std::size_t t = 0; t < frames; ++t) {
    if (!pose_input.Normalise(view, static_cast<int>(t), pose, turned_from_camera)) continue;
    batch.Add(t, pose, turned_from_camera);
    if (batch.size() == kChunk) batch.Lift(*state_->network, skeleton().root, state_->device, lifted);
  }
  batch.Lift(*state_->network, skeleton().root, state_->device, lifted);
  for (std::size_t i = 0; i < frames * joints; ++i) {
    if (!std::isfinite(lifted.rotation[9 * (i / joints)])) continue;
    lifted.pose_in_camera.confidence()[i] = lifted.canonical.confidence()[i] = view.confidence[i];
  }
  return lifted;
}

}  // namespace canonpose
