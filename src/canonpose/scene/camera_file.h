// A camera, or one for each frame, in the groups of our files: arrays K, R, t, distortion.
#pragma once

#include <string>
#include <vector>

#include "canonpose/base/hdf5.h"
#include "canonpose/geometry/camera.h"

namespace canonpose {

/// Reads the arrays `prefix`K (3, 3), R (3, 3), t (3) and distortion (4 or 5; absent: none), each also with a first
/// dimension of `frame_count`: x_in_camera = R x_in_world + t. One camera where all arrays hold one, `frame_count`
/// cameras otherwise, none where no array is there. Throws Error(kBadInput).
std::vector<Camera> ReadCameras(const h5::Group& group, int frame_count, const std::string& prefix = "");

/// Writes what ReadCameras() reads; nothing for no cameras. Arrays that are the same for all frames are written once.
void WriteCameras(h5::Group& group, const std::vector<Camera>& cameras, const std::string& prefix = "");

}  // namespace canonpose
