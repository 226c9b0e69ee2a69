// Learning from poses triangulated from 2D keypoints with known cameras.
//
// Kocabas et al., "Self-Supervised Learning of 3D Human Pose using Multi-view Geometry" (EpipolarPose), CVPR 2019.
#pragma once

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Replaces solved poses by triangulated ones (TriangulateSequence() of data/sequence_triangulation.h), and solved
/// cameras by the calibrated ones. Both are then in millimetres, and no uncertainty is known.
void LearnFromTriangulation(Dataset& dataset);

}  // namespace canonpose
