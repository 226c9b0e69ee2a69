// Poses seen from new cameras: the views of a recording are few, but a 3D pose can be filmed from anywhere.
//
// A pose is rotated about the vertical by any angle, its camera is tilted and rolled a little, and the person is placed
// where another pose of the set was in the image, at about the first pose's own distance. The other pose's camera
// projects it, and the detector's errors and missing joints there are added: a row as good as a real one.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/geometry/viewing_ray.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// The direction that is down (unit length, in the world), assuming that cameras are held level: the one most nearly
/// orthogonal to the x axes of all, on the side of their y axes. Nothing where the x axes are too nearly parallel.
std::optional<Eigen::Vector3d> EstimateDown(const std::vector<Eigen::Matrix3d>& camera_from_world);

/// A new camera for a pose.
struct NewCamera {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< offset from the root in the new camera = rotation * old
  double distance_factor = 1.0;                            ///< of the root from the camera
  int place = 0;  ///< the row that lends its place in the image, its intrinsics and its detector errors
};

class NewViews {
 public:
  /// Uses the rows of `set` whose pose and camera are known. Keeps a reference to `set`.
  NewViews(const std::vector<Dataset>& datasets, const TrainingSet& set, const RowForm& form);

  [[nodiscard]] bool any() const { return !usable_.empty(); }

  /// A random camera for a row. The standard deviation of tilt and roll is 5 degrees, that of the logarithm of the
  /// distance factor 0.15.
  [[nodiscard]] NewCamera Draw(int set_row, Rng& rng) const;

  /// Replaces keypoints, confidences and target of `row` by those of row `set_row` seen by `camera`. False, `row`
  /// unchanged, where the row's own camera is unknown or too few joints would be visible.
  [[nodiscard]] bool See(int set_row, const NewCamera& camera, const TrainingRow& row) const;

 private:
  struct Lens {
    Camera camera;   ///< only its intrinsics and distortion are used
    Pinhole turned;  ///< the intrinsics that the network's input is rotated with
  };
  void AddRow(const std::vector<Dataset>& datasets, const RowForm& form, int row);
  [[nodiscard]] Eigen::Vector3d Joint(int row, int joint) const;

  const TrainingSet& set_;
  int joints_;
  int root_;
  bool turns_;
  std::vector<float> poses_;  ///< (N, J, 3) in the camera, NaN where unknown
  /// (N, J, 2) keypoint - projection, divided by the pose's size in the image; NaN likewise. Solved poses have absorbed
  /// a part of the error, for which it is enlarged (ErrorFactor()).
  std::vector<float> errors_;
  std::vector<Eigen::Vector3d> down_;  ///< (N) in the camera
  std::vector<int> lens_of_;           ///< (N) -1 where pose or camera is unknown
  std::vector<Lens> lenses_;
  std::vector<int> usable_;  ///< rows with a lens
};

}  // namespace canonpose
