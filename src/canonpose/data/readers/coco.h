// COCO keypoint results: a flat list with whole numbers as image ids.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: a results file, or a folder with one such file per camera. Throws Error(kBadInput).
std::vector<CameraInput> FindCocoCameras(const std::filesystem::path& path);

/// Reads one camera; the image id is the frame number. These files leave out images without people, so gaps in the
/// numbering become frames without people. Throws Error(kBadInput).
DetectedCamera ReadCoco(const CameraInput& input);

}  // namespace canonpose
