// Learning from poses that known cameras make of 2D keypoints.
//
// Kocabas et al., "Self-Supervised Learning of 3D Human Pose using Multi-view Geometry" (EpipolarPose), CVPR 2019.
#pragma once

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Puts the poses that the calibration makes of the keypoints (data/sequence_triangulation.h, TriangulateSequence()) in
/// the place of solved ones, and the calibrated cameras in that of solved cameras.
void LearnFromTriangulation(Dataset& dataset);

}  // namespace canonpose
