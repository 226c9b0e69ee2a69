// The table of detector formats, and recognising the format of a path.
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

/// A format by name, ignoring case. Throws Error(kInvalidArgument) that lists the formats if there is none.
const DetectionFormat& FindDetectionFormat(std::string_view name);

/// "openpose, alphapose, ..."
std::string DetectionFormatNames();

/// The format of a file or folder, recognised by its content; for a folder by its first JSON file, or that of its first
/// sub-folder with one. Throws Error(kBadInput) where it is not recognised.
std::string DetectFormat(const std::filesystem::path& path);

/// The same; empty where it is not recognised or cannot be read.
std::string LooksLikeFormat(const std::filesystem::path& path);

/// Whether one of the first JSON files of a folder looks like a format.
bool HasDetections(const std::filesystem::path& folder);

/// The format that parsed content looks like; empty if none.
std::string GuessFormat(const JsonValue& root);

/// What parsed content is, for messages: "a COCO dataset with 3 images and 5 annotations", "a calibration of cameras a,
/// b", "an array of 12 objects with bbox, id".
std::string DescribeContent(const JsonValue& root);
/// What to do with content of no known format.
std::string AdviceForContent(const JsonValue& root);

}  // namespace canonpose
