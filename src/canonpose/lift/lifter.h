// A trained model at work: 2D poses of one camera in, 3D poses out. No LibTorch in this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

/// 3D poses of T frames in the network's unit, each in a scale of its own; NaN in frames whose 2D pose cannot be used
/// (geometry/normalisation.h). Root-centred: pose_in_camera = rotation * canonical.
struct LiftedPoses {
  int frame_count = 0;
  int joint_count = 0;
  std::vector<float> pose_in_camera;  ///< (T, J, 3) x right, y down, z forward
  std::vector<float> canonical;       ///< (T, J, 3)
  std::vector<float> rotation;        ///< (T, 3, 3) camera_from_canonical
};

class PoseLifter {
 public:
  /// Opens a model file or the folder of a finished run. `device` is cpu or cuda. Throws Error(kBadInput).
  static PoseLifter Open(const std::filesystem::path& run_or_model, const std::string& device = "cpu");
  /// A lifter of a model that was read already; errors call it `name`.
  static PoseLifter Of(ModelFile model, const std::string& name, const std::string& device = "cpu");
  ~PoseLifter();
  PoseLifter(PoseLifter&&) noexcept;
  PoseLifter& operator=(PoseLifter&&) = delete;

  [[nodiscard]] const ModelInfo& info() const;
  [[nodiscard]] const Skeleton& skeleton() const { return info().skeleton; }

  /// Lifts the T frames of a view whose joints are those of skeleton(), as the detector found them.
  [[nodiscard]] LiftedPoses Lift(const CameraView& view, int frame_count) const;

  /// Throws Error(kBadInput) naming `file` where data of `other` cannot be lifted by this model.
  void RequireSkeleton(const Skeleton& other, const std::string& file) const;

 private:
  struct State;
  /// What Lift() does with a view that went through the model's morphing network, where it has one.
  [[nodiscard]] LiftedPoses LiftMorphed(const CameraView& view, int frame_count) const;
  explicit PoseLifter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Turns every pose to millimetres of a person `height_mm` tall: each pose gets the same sum of bone lengths, and the
/// person's stature is the median over frames of the path from an ankle over the hips to the head, which are 3.9 %
/// and, for a head joint, 100 % of the stature above ground (Winter, Biomechanics and Motor Control of Human Movement).
/// Throws Error(kBadInput) where the skeleton has no such path.
void ScaleToHeight(LiftedPoses& poses, const Skeleton& skeleton, double height_mm);

/// The least window of Smooth().
inline constexpr int kMinSmoothing = 5;

/// Replaces every pose by the middle of the quadratics in time that fit each coordinate best over `window_frames`
/// frames (Savitzky and Golay 1964; at gaps and ends over those that there are); canonical poses follow, rotations
/// stay. `frames` (T, ascending) are the frames' numbers. A frame that is NaN stays so and has no part; so does one
/// with too few frames around it keep its pose.
void Smooth(LiftedPoses& poses, std::span<const std::int64_t> frames, int window_frames);

}  // namespace canonpose
