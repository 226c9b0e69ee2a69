// A start that needs no lifter: factorisation of the keypoints of static cameras.
//
// Under scaled orthography, view v sees joint j of frame n at  s_nv M_v X_nj + t_nv,  where M_v is two rows of a
// rotation. The keypoints of a capture therefore form a matrix of rank 3 (Tomasi and Kanade 1992), which determines M_v
// and X_nj up to an invertible matrix T: M_v T and T^-1 X_nj give the same keypoints. The metric upgrade finds T from
// two conditions: the rows of M_v T are orthogonal and equally long, and bones keep their proportions through all
// frames that share the cameras. The second is needed because two cameras, or cameras opposite each other, do not
// determine T by the first alone. What remains is the depth-reversal ambiguity: orthography cannot distinguish a
// solution from its mirror.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Cameras and joints of a static capture under scaled orthography, or their mirror.
struct Factorisation {
  std::vector<Eigen::Matrix3d> camera_from_world;  ///< (V); NaN where the camera sees too little
  /// (F, J) in the world, each frame with an origin and a unit of its own; NaN where fewer than two cameras see it.
  std::vector<Eigen::Vector3d> joints;
};

/// Needs kMinFrames (diagnosis.h) in which two cameras or more see the same six joints; all NaN otherwise. Cameras must
/// be static.
Factorisation Factorise(const CaptureObservations& capture);

/// The poses of every view by factorisation, whatever the skeleton. Throws Error(kBadInput) where cameras move; `file`
/// names the dataset in the message.
StartPoses FactorisedStart(const Dataset& dataset, const std::string& file);

}  // namespace canonpose
