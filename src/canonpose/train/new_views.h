// Poses seen from new cameras: the views of a recording are few, but a 3D pose can be filmed from anywhere.
//
// A pose is turned about the vertical by any angle, its camera tilted and rolled a little, and the person set down
// where another pose of the set stood in the image, at about the pose's own distance. What that pose's camera sees of
// it, together with the detector's error there and the joints it missed, is a row as good as a real one.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/geometry/viewing_ray.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// The direction that is down (unit length, in the world) if operated cameras stand level: the one most nearly
/// orthogonal to the x axes of all, with their y axes on its side. Nothing where their x axes are too parallel to say.
std::optional<Eigen::Vector3d> EstimateDown(const std::vector<Eigen::Matrix3d>& camera_from_world);

/// How a pose is filmed anew.
struct NewCamera {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< offset from the root in the new camera = rotation * old
  double distance_factor = 1.0;                            ///< of the root from the camera
  int place = 0;  ///< the row whose place in the image, camera and detector's error it gets
};

class NewViews {
 public:
  /// Rows of `set` whose pose and camera are known. Keeps a reference to `set`.
  NewViews(const std::vector<Dataset>& datasets, const TrainingSet& set, const RowForm& form);

  [[nodiscard]] bool any() const { return !usable_.empty(); }

  /// A new camera for a row. Tilt and roll have a standard deviation of 5 degrees, the logarithm of the distance factor
  /// one of 0.15.
  [[nodiscard]] NewCamera Draw(int set_row, Rng& rng) const;

  /// Makes keypoints, confidences and target of `row` those of row `set_row` seen by `camera`. False, with `row` as it
  /// was, where the row's own camera is not known or too little of it would be seen.
  [[nodiscard]] bool See(int set_row, const NewCamera& camera, const TrainingRow& row) const;

 private:
  struct Lens {
    Camera camera;   ///< of which intrinsics and distortion alone are used
    Pinhole turned;  ///< what the network's input is turned with
  };
  void AddRow(const std::vector<Dataset>& datasets, const RowForm& form, int row);
  [[nodiscard]] Eigen::Vector3d Joint(int row, int joint) const;

  const TrainingSet& set_;
  int joints_;
  int root_;
  bool turns_;
  std::vector<float> poses_;   ///< (N, J, 3) in the camera, NaN where unknown
  std::vector<float> errors_;  ///< (N, J, 2) keypoint - projection, divided by the pose's size in the image; of solved
                               ///< poses enlarged by what they have taken up of it; NaN likewise
  std::vector<Eigen::Vector3d> down_;  ///< (N) in the camera
  std::vector<int> lens_of_;           ///< (N) -1 where pose or camera are not known
  std::vector<Lens> lenses_;
  std::vector<int> usable_;  ///< rows with a lens
};

}  // namespace canonpose
