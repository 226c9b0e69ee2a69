// AlphaPose's JSON: the default flat list, and the "open" and "cmu" forms as one file or as a folder sep-json.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: a results file, a folder with one such file per camera, a folder of frames (sep-json), or a
/// folder of folders that contain one of these each. Throws Error(kBadInput).
std::vector<CameraInput> FindAlphaPoseCameras(const std::filesystem::path& path);

/// Reads one camera. These files leave out images without people, so gaps in the numbering become frames without
/// people. Throws Error(kBadInput).
DetectedCamera ReadAlphaPose(const CameraInput& input);

}  // namespace canonpose
