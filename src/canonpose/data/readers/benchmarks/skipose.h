// Ski-PosePTZ: labels.h5 of skiers before six cameras that pan, tilt and zoom.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// A labels.h5, its folder, or the folder that holds train/ and test/. A row per view: seq, cam, frame, subj, 3D (51),
/// 2D (34, fractions of the 256x256 image), cam_intrinsic (9, for an image of size 1), cam_position (3), R_cam_2_world
/// (9); joints in Human3.6M's order. A sequence per subject and seq, "S1 seq_103", with a camera per cam; a view that
/// is not there is unknown.
///
/// Nothing in the file says in which frame and unit 3D is. The unit is told by the length of legs, for the places of
/// the cameras too. The frame is the one whose projection is 2D: the camera's or the world's, with the person's place
/// or without it; where that is missing it is found from 2D. Legs that are called by the other side's name are renamed.
/// All of that is told in the log. Throws Error(kBadInput).
Dataset ImportSkiPose(const BenchmarkOptions& options);

}  // namespace canonpose
