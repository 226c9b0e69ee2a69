// MMPose 1.x JSON: predictions of a video, of single images, and of the demo scripts.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: a video's file, a folder with one such file a camera, a folder of images' files, or a folder
/// of folders that hold one of these each. Throws Error(kBadInput).
std::vector<CameraInput> FindMmposeCameras(const std::filesystem::path& path);

/// Reads one camera. Throws Error(kBadInput).
DetectedCamera ReadMmpose(const CameraInput& input);

}  // namespace canonpose
