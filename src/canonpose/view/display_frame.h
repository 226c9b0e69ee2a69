// How a scene is put on a screen: z up, the floor at 0, about in metres.
#pragma once

#include <Eigen/Core>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// point_on_display = scale * rotation * (point_in_world - origin). In displayed coordinates z points up, the floor is
/// z = 0 and an adult is about 1.7 tall.
struct DisplayFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1.0;
  bool up_is_guess = false;     ///< the scene does not know it: taken from the cameras, which people hold about level
  bool floor_is_guess = false;  ///< the scene does not know it: below the lowest joints
  bool is_metric = false;       ///< a displayed 1 is a metre

  [[nodiscard]] Eigen::Vector3d Show(const Eigen::Vector3d& in_world) const {
    return scale * (rotation * (in_world - origin));
  }
};

/// Of a scene by itself. People in the frame of a camera, as a single view gives them, are shown as if it were level.
DisplayFrame MakeDisplayFrame(const Scene& scene);

/// Of another result for the scene that `frame` shows, so that they lie upon each other: by the similarity that aligns
/// the joints of the same name of all people in all frames. MakeDisplayFrame(scene) where they have too little in
/// common.
DisplayFrame MakeDisplayFrameLike(const Scene& shown, const DisplayFrame& frame, const Scene& scene);

/// The sum of the lengths of a person's bones, each the median over time; 0 where nothing is known.
double BoneLengthSum(const PoseSequence& person);

}  // namespace canonpose
