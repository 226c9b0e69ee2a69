// OpenPose's JSON: a folder a camera, a file a frame (--write_json).
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: the folder itself where it holds frames, or its sub-folders where those do; JSON files beside
/// sub-folders, such as a calibration, are then not looked at. Throws Error(kBadInput) for an empty folder or a file.
std::vector<CameraInput> FindOpenPoseCameras(const std::filesystem::path& path);

/// Reads one camera's folder. Throws Error(kBadInput).
DetectedCamera ReadOpenPose(const CameraInput& input);

}  // namespace canonpose
