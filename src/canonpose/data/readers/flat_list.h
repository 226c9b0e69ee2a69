// The flat list of detections that COCO results and AlphaPose's default form share, and paths with one JSON file per
// camera.
//
// For readers only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// Adds [{image_id, keypoints: [x, y, c, ...], score?, idx?, category_id?}, ...] to a camera, with any number of
/// entries per image. image_id is the image's name or number. Where there are several categories, only COCO's person
/// (1) is kept, with a warning. Throws Error(kBadInput).
void ReadFlatList(const JsonValue& list, CameraBuilder& builder);

/// x, y, c triples of `value`, with NaN where the file has null or NaN; throws Error(kBadInput) where their number is
/// wrong.
std::vector<double> Triples(const JsonValue& value);

/// Whether a JSON file in a camera's folder is one frame of that camera.
using IsFrameFile = bool (*)(const std::filesystem::path& file);

/// The cameras of a path. A file is a camera, and so is a folder of frame files. In any other folder, each file with
/// detections is a camera; or each sub-folder, if there are none. Files with anything else are left out, and those that
/// are not calibrations are reported. Throws Error(kBadInput) where there is no camera.
std::vector<CameraInput> FindFileCameras(const std::filesystem::path& path, IsFrameFile is_frame_file);

/// Reads all files of a camera's folder by `read`, which returns false for a file that has no keypoints; such files are
/// left out. So are damaged files without a number in their name. Throws Error(kBadInput) where none has keypoints.
void ReadFrameFiles(const CameraInput& input, CameraBuilder& builder, bool (*read)(const JsonValue&, CameraBuilder&),
                    const std::string& expected);

/// What is in a folder without JSON files: "an empty folder", "4 videos (cam1.mp4 and 3 more)", or kNoJsonFile.
inline constexpr const char* kNoJsonFile = "no JSON file";
std::string DescribeFolder(const std::filesystem::path& folder);
/// What to do about that; `advice` where nothing in particular.
std::string AdviseFolder(const std::filesystem::path& folder, const std::string& advice);

/// Throws Error(kBadInput) at a file of another structure: what is in it, and what to do.
[[noreturn]] void FailFormat(const JsonValue& root, const std::string& expected);

}  // namespace canonpose
