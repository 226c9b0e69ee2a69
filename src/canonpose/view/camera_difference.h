// How far the solution, seen by each camera, is from what was detected there.
#pragma once

#include <vector>

#include "canonpose/view/page_content.h"

namespace canonpose {

/// Of one camera. Everything is NaN where nothing can be compared.
struct CameraDifference {
  std::vector<float> by_frame_px;  ///< (T) the median over people and joints, in the camera's own frames
  std::vector<float> by_joint_px;  ///< (J of the first person) the median over frames
  double median_px = 0.0;          ///< over everything
  double median_percent = 0.0;     ///< the same, in percent of the sum of the body's bone lengths at its distance
};

/// The person at a camera's frame, which is another time than the people's frame of this number where its clock is off;
/// between frames on the line between them. NaN where either is missing.
Eigen::Vector3d JointAt(const PoseSequence& person, double frame, int joint);

/// For each camera of the scene.
std::vector<CameraDifference> CompareCameras(const ShownScene& shown);

}  // namespace canonpose
