// A start that needs no lifter: the keypoints of static cameras, factorised.
//
// Under scaled orthography view v sees joint j of frame n at  s_nv M_v X_nj + t_nv,  M_v being two rows of a rotation,
// so that all keypoints of a capture are a matrix of rank 3 (Tomasi and Kanade 1992). Any invertible T gives the same
// keypoints with M_v T and T^-1 X_nj; what settles it, the metric upgrade, is that the rows of M_v T are orthogonal and
// of equal length, and that bones keep their proportions through all frames that share the cameras. The second is
// needed: the views of two cameras, or of a rig whose cameras stand opposite each other, leave the first undetermined.
// What remains is the depth mirror, about which orthography says nothing.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// What the keypoints of a static capture say under scaled orthography, up to a depth mirror.
struct Factorisation {
  std::vector<Eigen::Matrix3d> camera_from_world;  ///< (V); NaN where the camera sees too little
  std::vector<Eigen::Vector3d> joints;  ///< (F, J) in the world, each frame in a unit and about a point of its
                                        ///< own; NaN where fewer than two cameras see it
};

/// Needs kMinFrames (diagnosis.h) of which at least two cameras show the same six joints; all NaN otherwise. Not for
/// moving cameras.
Factorisation Factorise(const CaptureObservations& capture);

/// The poses of every view by factorisation, for any body. Throws Error(kBadInput) where cameras move; `file` is the
/// dataset's name for the message.
StartPoses FactorisedStart(const Dataset& dataset, const std::string& file);

}  // namespace canonpose
