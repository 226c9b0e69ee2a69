// The flat list of detections that COCO results and AlphaPose's default form share, and paths with one JSON file a
// camera.
//
// Internal to the readers.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// Adds [{image_id, keypoints: [x, y, c, ...], score?, idx?}, ...] to a camera, several entries an image. image_id is
/// the image's name or its number. Throws Error(kBadInput).
void ReadFlatList(const JsonValue& list, CameraBuilder& builder);

/// x, y, c triples of `value`; throws Error(kBadInput) where their number is wrong.
std::vector<double> Triples(const JsonValue& value);

/// Whether a JSON file of a folder is one frame of the camera that the folder is.
using IsFrameFile = bool (*)(const std::filesystem::path& file);

/// The cameras of a path: a file is a camera; so is a folder of frame files; the files of another folder are a camera
/// each, and so are its sub-folders where it has no JSON file but calibrations. Throws Error(kBadInput) where there is
/// none.
std::vector<CameraInput> FindFileCameras(const std::filesystem::path& path, IsFrameFile is_frame_file);

/// A hint at the right importer for a message: what the content looks like, if it is known; empty otherwise.
std::string AdviseFormat(const JsonValue& root);

}  // namespace canonpose
