// Human3.6M in the form of VideoPose3D: data_2d_h36m_*.npz, data_3d_h36m.npz, and its cameras as JSON.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Paths: the 2D poses, `positions_2d` {subject: {action: [per camera (T, 17, 2 or 3) px]}} and `metadata`, and perhaps
/// the 3D poses, `positions_3d` {subject: {action: (T, 32, 3)}} in the world's frame, in either order. A third column
/// is the confidence; without it all are 1.
///
/// The cameras are in the source of VideoPose3D (common/h36m_dataset.py) and are given as JSON, {"extrinsic":
/// h36m_cameras_extrinsic_params, "intrinsic": h36m_cameras_intrinsic_params}: per subject and camera `orientation` (a
/// quaternion w, x, y, z from the camera to the world) and `translation` (the camera's place, mm), so that x_in_camera
/// = orientation^-1 (x_in_world - translation). Its tangential distortion becomes OpenCV's p1 and p2. Truth needs both
/// 3D poses and cameras.
///
/// A sequence per subject and action, "S9 Walking 1", 50 frames a second; all of a subject are one capture. Where 2D
/// goes on after 3D it is cut, as VideoPose3D does. Throws Error(kBadInput).
Dataset ImportH36m(const BenchmarkOptions& options);

}  // namespace canonpose
