#include "canonpose/pipeline/lift_views.h"

#include <climits>
#include <numeric>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/import.h"
#include "canonpose/data/own_layout.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// The element of that name, or the only one where no name is given. `what` is the field that chooses.
template <typename Element>
const Element& Choose(const std::vector<Element>& elements, const std::string& name, const std::string& what,
                      const std::string& file) {
  std::string names;
  for (const Element& element : elements) {
    if (element.name == name || (name.empty() && elements.size() == 1)) return element;
    names += (names.empty() ? "" : ", ") + element.name;
  }
  ThrowBadInput({file, "", name.empty() ? "one " + what : what + " " + name, names, "choose one with `" + what + "`"});
}

/// Keypoints must mean what they meant in training: moved by the same morphing network, or by none.
void WarnOfOtherMorph(const ModelInfo& model, const DatasetSource& source, const std::string& file) {
  if (model.source.morph == source.morph) return;
  const auto describe = [](const std::string& morph) { return morph.empty() ? "nothing" : morph; };
  LogWarning(
      "{}: its keypoints were moved by {} when they were imported, those that the model learned from by {}: 3D "
      "poses will be off; import them in the same way (`morph`)",
      file, describe(source.morph), describe(model.source.morph));
}

LiftInput FromDataset(const fs::path& path, const LiftChoice& choice, const PoseLifter& lifter) {
  Dataset dataset = ReadDataset(path);
  lifter.RequireSkeleton(dataset.skeleton, path.string());
  WarnOfOtherMorph(lifter.info(), dataset.source, path.string());
  const FrameRange range = choice.frames.empty() ? FrameRange{} : FrameRange::Parse(choice.frames);
  if (!choice.frames.empty()) KeepFrames(dataset, range, path.string());
  const Sequence& sequence = Choose(dataset.sequences, choice.sequence, "sequence", path.string());
  LiftInput input{Choose(sequence.cameras, choice.camera, "camera", path.string()), {}, sequence.fps};
  input.frames.resize(static_cast<std::size_t>(sequence.frame_count));
  std::iota(input.frames.begin(), input.frames.end(), range.first);
  return input;
}

LiftInput FromDetections(const fs::path& path, const LiftChoice& choice, const PoseLifter& lifter) {
  const DatasetSource& source = lifter.info().source;
  RequireLayoutName(choice.layout);
  SingleCameraOptions options;
  options.format = choice.format;
  options.layout = choice.layout.empty() ? source.layout : choice.layout;
  // Confidences must have the scale that they had in training; other detectors have other scales.
  options.confidence_scale = options.layout == source.layout ? source.confidence_scale : 0.0;
  options.skeleton = lifter.skeleton();
  options.camera = choice.camera;
  options.person = choice.person;
  options.image_size = choice.image_size;
  SingleCamera single = ReadSingleCamera(path, options);
  WarnOfOtherMorph(lifter.info(), single.source, path.string());
  return {std::move(single.view), std::move(single.frame_numbers), single.fps};
}

}  // namespace

LiftInput ReadLiftInput(const fs::path& path, const LiftChoice& choice, const PoseLifter& lifter) {
  if (!fs::exists(path)) {
    ThrowBadInput({path.string(), "", "a dataset or a detector's files", "nothing", "check the path"});
  }
  return IsDatasetFile(path) ? FromDataset(path, choice, lifter) : FromDetections(path, choice, lifter);
}

void LiftOptions::Validate() const {
  if (height_m) RequireHeight(*height_m);
  if (smooth_frames) RequireSmoothing(*smooth_frames, INT_MAX);
}

LiftedPoses LiftViews(const PoseLifter& lifter, const LiftInput& input, const LiftOptions& options,
                      const std::string& file) {
  options.Validate();
  const auto frame_count = static_cast<int>(input.frames.size());
  if (options.smooth_frames) RequireSmoothing(*options.smooth_frames, frame_count);
  lifter.RequireImageSize(input.view, file);
  LiftedPoses lifted = lifter.Lift(input.view, frame_count);
  lifted.frames = input.frames;
  lifted.pose_in_camera.fps = lifted.canonical.fps = input.fps;
  if (options.height_m) ScaleToHeight(lifted, 1000.0 * *options.height_m);
  if (!options.fill) lifted.HideUnseenJoints();
  if (options.smooth_frames) Smooth(lifted, *options.smooth_frames);
  return lifted;
}

}  // namespace canonpose
