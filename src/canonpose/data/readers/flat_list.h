// The flat list of detections that COCO results and AlphaPose's default form share, and paths with one JSON file per
// camera.
//
// For readers only.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// Adds [{image_id, keypoints: [x, y, c, ...], score?, idx?}, ...] to a camera, with any number of entries per image.
/// image_id is the image's name or number. Throws Error(kBadInput).
void ReadFlatList(const JsonValue& list, CameraBuilder& builder);

/// x, y, c triples of `value`; throws Error(kBadInput) where their number is wrong.
std::vector<double> Triples(const JsonValue& value);

/// Whether a JSON file in a camera's folder is one frame of that camera.
using IsFrameFile = bool (*)(const std::filesystem::path& file);

/// The cameras of a path. A file is a camera, and so is a folder of frame files. In any other folder, each file is a
/// camera; or each sub-folder, if the only JSON files are calibrations. Throws Error(kBadInput) where there is no
/// camera.
std::vector<CameraInput> FindFileCameras(const std::filesystem::path& path, IsFrameFile is_frame_file);

/// A hint for messages: which format the content looks like; empty if it looks like none.
std::string AdviseFormat(const JsonValue& root);

}  // namespace canonpose
