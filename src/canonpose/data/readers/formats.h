// The table of detector formats, and which of them a path is.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

class JsonValue;

struct DetectionFormat {
  std::string_view name;  ///< as on the command line
  std::vector<CameraInput> (*find_cameras)(const std::filesystem::path& path);
  DetectedCamera (*read)(const CameraInput& input);
};

const std::vector<DetectionFormat>& DetectionFormats();

/// By name, ignoring case. Throws Error(kInvalidArgument) naming all where there is none.
const DetectionFormat& FindDetectionFormat(std::string_view name);

/// "openpose, alphapose, ..."
std::string DetectionFormatNames();

/// The format of a file or folder from its content: for a folder from its first JSON file, or that of its first
/// sub-folder with one. Throws Error(kBadInput) where it cannot be told.
std::string DetectFormat(const std::filesystem::path& path);

/// The format that parsed content looks like; empty where it is none of them.
std::string GuessFormat(const JsonValue& root);

}  // namespace canonpose
