// Human3.6M in the form of VideoPose3D: data_2d_h36m_*.npz, data_3d_h36m.npz, and its cameras as JSON.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Reads the file of 2D poses, `positions_2d` {subject: {action: [per camera (T, 17, 2 or 3) px]}} and `metadata`, and
/// optionally that of 3D poses, `positions_3d` {subject: {action: (T, 32, 3)}} in the world's frame; the paths may be
/// in either order. The third column of 2D poses is the confidence; without it all confidences are 1.
///
/// The cameras are part of VideoPose3D's source (common/h36m_dataset.py) and must be given as JSON, {"extrinsic":
/// h36m_cameras_extrinsic_params, "intrinsic": h36m_cameras_intrinsic_params}: per subject and camera the `orientation`
/// (a quaternion w, x, y, z from the camera to the world) and the `translation` (the camera's position, mm), so that
/// x_in_camera = orientation^-1 (x_in_world - translation). The tangential distortion becomes OpenCV's p1 and p2. Truth
/// requires both 3D poses and cameras.
///
/// There is one sequence per subject and action, "S9 Walking 1", with 50 frames per second; all of a subject are one
/// capture. Where there are more 2D than 3D frames, the rest is cut off, as in VideoPose3D. Throws Error(kBadInput).
Dataset ImportH36m(const BenchmarkOptions& options);

}  // namespace canonpose
