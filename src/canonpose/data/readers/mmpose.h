// MMPose 1.x JSON: predictions of a video, of single images, and of the demo scripts.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: the file of a video, a folder with one such file per camera, a folder with one file per
/// image, or a folder of folders that contain one of these each. Throws Error(kBadInput).
std::vector<CameraInput> FindMmposeCameras(const std::filesystem::path& path);

/// Reads one camera. Throws Error(kBadInput).
DetectedCamera ReadMmpose(const CameraInput& input);

}  // namespace canonpose
