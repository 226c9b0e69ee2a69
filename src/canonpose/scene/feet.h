// When and where a person's feet stand still.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// A joint of a foot that hardly moves for a while, while no other is clearly below it.
struct Stance {
  Eigen::Vector3d position;  ///< the mean, in the coordinates of the poses
  double height = 0.0;       ///< of the joint above the floor, if the foot is flat on it
  double uncertainty = 0.0;  ///< of the height and of the position: a standard deviation
  int first_frame = 0;
  int last_frame = 0;  ///< inclusive
};

/// The feet of a person: ankles, heels and toes, as far as the skeleton has them. Lengths are in the unit of the poses.
class Feet {
 public:
  /// `person` must outlive the feet.
  Feet(const PoseSequence& person, double stature);

  /// Whether the skeleton has any of their joints.
  [[nodiscard]] bool any() const { return !joints_.empty(); }
  /// Whether it has ankles and no more: then the floor is below them by what is usual.
  [[nodiscard]] bool only_ankles() const { return only_ankles_; }
  [[nodiscard]] int frame_count() const { return person_->frame_count(); }
  [[nodiscard]] double stature() const { return stature_; }
  /// The smallest uncertainty of a joint's height above the floor.
  [[nodiscard]] double height_uncertainty() const;
  /// How high the lower foot's sole is along `up` in a frame, from the origin; NaN where no foot is known.
  [[nodiscard]] double LowestSole(int frame, const Eigen::Vector3d& up) const;
  /// Joints that move by less than about a quarter of a metre per second for a tenth of a second or longer, and are not
  /// clearly above the lowest one: a foot that is held up is not on the floor. In the order of joints and time.
  [[nodiscard]] std::vector<Stance> Stances(const Eigen::Vector3d& up) const;

 private:
  struct Joint {
    int joint;
    double height;       ///< above the floor
    double uncertainty;  ///< of the height
  };

  [[nodiscard]] Eigen::Vector3d At(int frame, const Joint& joint) const {
    return person_->PoseAt(frame).row(joint.joint).transpose().cast<double>();
  }

  const PoseSequence* person_;
  double stature_;
  double fps_;
  bool only_ankles_ = true;
  std::vector<Joint> joints_;
};

}  // namespace canonpose
