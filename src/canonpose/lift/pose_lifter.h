// Applies a trained model: 2D poses of one camera in, 3D poses out. No LibTorch in this header.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/scene/lifted_poses.h"

namespace canonpose {

class PoseLifter {
 public:
  /// Opens a model file or the folder of a finished run. `device` is cpu or cuda. Throws Error(kBadInput).
  static PoseLifter Open(const std::filesystem::path& run_or_model, const std::string& device = "cpu");
  /// From a model in memory; errors call it `name`.
  static PoseLifter Of(ModelFile model, const std::string& name, const std::string& device = "cpu");
  ~PoseLifter();
  PoseLifter(PoseLifter&&) noexcept;
  PoseLifter& operator=(PoseLifter&&) = delete;

  [[nodiscard]] const ModelInfo& info() const;
  [[nodiscard]] const Skeleton& skeleton() const { return info().skeleton; }

  /// Lifts the T frames of a view. Its joints are those of skeleton(), as detected: a morphing network that the model
  /// was trained with is applied here. Frames whose 2D pose cannot be normalised (geometry/normalisation.h) stay
  /// missing. Joints that are not detected are the network's guess, with confidence 0. Frames are numbered from 0.
  [[nodiscard]] LiftedPoses Lift(const CameraView& view, int frame_count) const;

  /// Throws Error(kBadInput) naming `file` where this model needs the image size (or a calibration) and the view has
  /// none: poses away from the image centre would be tilted. Lift() only warns of it.
  void RequireImageSize(const CameraView& view, const std::string& file) const;

  /// Throws Error(kBadInput) naming `file` where data of `other` cannot be lifted by this model.
  void RequireSkeleton(const Skeleton& other, const std::string& file) const;

 private:
  struct State;
  /// Lift() for a view whose joints are morphed already, or need not be.
  [[nodiscard]] LiftedPoses LiftMorphed(const CameraView& view, int frame_count) const;
  explicit PoseLifter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Scales all poses to millimetres, for a person of stature `height_mm`. Every pose gets the same sum of bone lengths,
/// such that the median length over frames of the path from an ankle over the hips to the head is the difference of
/// their heights: an ankle is at 3.9 % of the stature, a head joint at 100 % (Winter, Biomechanics and Motor Control of
/// Human Movement). Throws Error(kBadInput) where the skeleton has no such path.
void ScaleToHeight(LiftedPoses& poses, double height_mm);

/// The smallest window of Smooth(), in frames.
inline constexpr int kMinSmoothing = 5;

/// Throws Error(kInvalidArgument) where Smooth() cannot take the window: it must be odd, so that there are as many
/// frames before as after the one in its middle, at least kMinSmoothing, and no longer than the clip.
void RequireSmoothing(int window_frames, int frame_count);

/// Smooths poses over time (Savitzky and Golay 1964): for every frame and coordinate, a quadratic is fitted to
/// `window_frames` frames around it, fewer at gaps (in LiftedPoses::frames) and ends, and evaluated at the frame.
/// Canonical poses follow, rotations stay. Joints that are NaN stay NaN and take no part; those with too few others
/// around them keep their positions.
void Smooth(LiftedPoses& poses, int window_frames);

}  // namespace canonpose
