// How a view's 2D pose becomes the network's input, the same in training and lifting. No LibTorch in this header.
#pragma once

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/geometry/viewing_ray.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

/// Makes the input of a network of a certain form.
///
/// With RayForm::kRoot the network's input and output belong to a camera that is rotated to have the root on its
/// optical axis. The transpose of `turned_from_camera` takes its rotations and poses back into the camera's own frame.
class PoseInput {
 public:
  PoseInput(const InputForm& form, const Skeleton& skeleton);

  /// The normalised pose of frame t of `view`, and the rotation, which is the identity with RayForm::kOff. False where
  /// the pose cannot be normalised (geometry/normalisation.h).
  [[nodiscard]] bool Normalise(const CameraView& view, int t, NormalisedPose& pose,
                               Eigen::Matrix3d& turned_from_camera) const;

  /// The intrinsics that the rotation is computed with: with FocalSource::kKnown the solved ones, or else the
  /// calibrated ones, where there are any; otherwise guessed from the image size.
  [[nodiscard]] Pinhole PinholeOf(const CameraView& view, int t) const;

  /// Whether too little is known about the camera to compute the rotation, so that poses stay as they are.
  [[nodiscard]] bool LacksCamera(const CameraView& view) const;

 private:
  bool turns_;
  bool uses_known_;
  int joint_count_;
  int root_;
};

}  // namespace canonpose
