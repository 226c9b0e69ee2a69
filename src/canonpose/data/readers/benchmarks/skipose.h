// Ski-PosePTZ: labels.h5, skiers filmed by six cameras that pan, tilt and zoom.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// A path is a labels.h5, its folder, or the folder that contains train/ and test/. The file has one row per view: seq,
/// cam, frame, subj, 3D (51), 2D (34, fractions of the 256x256 image), cam_intrinsic (9, for an image of size 1),
/// cam_position (3), R_cam_2_world (9); joints are in Human3.6M's order. There is one sequence per subject and seq, "S1
/// seq_103", with one camera per cam; missing views are unknown.
///
/// The file does not say in which frame and unit 3D is. The unit, also that of the cameras' positions, follows from the
/// length of legs. The frame is the one whose projection is 2D: the camera's or the world's, with or without the
/// person's position, which is found from 2D if it is missing. Legs with the other side's name are renamed. All of this
/// is logged. Throws Error(kBadInput).
Dataset ImportSkiPose(const BenchmarkOptions& options);

}  // namespace canonpose
