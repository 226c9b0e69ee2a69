// OpenPose's JSON: one folder per camera, one file per frame (its option write_json).
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: the folder itself if it contains frames, or its sub-folders if those do; JSON files beside
/// sub-folders, such as a calibration, are then ignored. Throws Error(kBadInput) for an empty folder or a file.
std::vector<CameraInput> FindOpenPoseCameras(const std::filesystem::path& path);

/// Reads one camera's folder. Throws Error(kBadInput).
DetectedCamera ReadOpenPose(const CameraInput& input);

}  // namespace canonpose
