// What the network sees of a view: one rule for training and lifting. No LibTorch here.
#pragma once

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/geometry/viewing_ray.h"
#include "canonpose/model/model_file.h"

namespace canonpose {

/// A view's 2D poses as a network of a certain form takes them.
///
/// With ray = "root" the network sees, and answers for, a camera that is turned to have the root on its optical axis:
/// what it says of a rotation or a pose is brought back by the transpose of turned_from_camera.
class PoseInput {
 public:
  PoseInput(const InputForm& form, const Skeleton& skeleton);

  /// The pose of frame t of `view`, and the turn, which is the identity with ray = "off". False where the pose cannot
  /// be used (geometry/normalisation.h).
  [[nodiscard]] bool Normalise(const CameraView& view, int t, NormalisedPose& pose,
                               Eigen::Matrix3d& turned_from_camera) const;

  /// The intrinsics the turn is made with: with focal = "known" the solved ones, or the calibrated, where there are
  /// any, otherwise what is guessed from the image size.
  [[nodiscard]] Pinhole PinholeOf(const CameraView& view, int t) const;

  /// Whether the turn needs more than is known of the camera, so that nothing would be turned.
  [[nodiscard]] bool LacksCamera(const CameraView& view) const;

 private:
  bool turns_;
  bool uses_known_;
  int joint_count_;
  int root_;
};

}  // namespace canonpose
