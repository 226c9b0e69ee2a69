// Ultralytics' pose models (YOLO): a text file per frame (save_txt), or JSON (Results.to_json()).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

class JsonValue;

/// The cameras of a path: a folder of text files, one per frame, or of such folders ("labels" below them is found); a
/// folder in which several videos' frames have names of their own (cam1_12.txt, cam2_12.txt), each of which is a
/// camera; or JSON, as for other detectors. Throws Error(kBadInput).
std::vector<CameraInput> FindUltralyticsCameras(const std::filesystem::path& path);

/// Reads one camera.
/// - Text: class, box (4), then x, y and, for most models, a confidence of each keypoint, all but the class as
/// fractions of
///   the image; then the person's confidence (save_conf) and the track's number, where they are there. 17 keypoints are
///   assumed (COCO-17), or `input.keypoint_count`.
/// - JSON: a list of people ({name, class, confidence, box, track_id?, keypoints: {x, y, visible?}}) for each frame, in
///   pixels or as fractions: a file per frame, a list of such lists, an object of them by frame, or a list of people
///   that have a member frame.
/// Class 0, a person, is read; a warning counts the others. Frames without a file, and with an empty one, are frames
/// without people. Throws Error(kBadInput).
DetectedCamera ReadUltralytics(const CameraInput& input);

/// Whether JSON looks like such results.
bool LooksLikeUltralytics(const JsonValue& root);

namespace ultralytics {

/// The classes of what was left out, with their numbers.
using OtherClasses = std::map<std::int64_t, std::size_t>;

/// Adds the frames of text files, one each.
void ReadText(const std::vector<std::filesystem::path>& files, int keypoint_count, CameraBuilder& builder,
              OtherClasses& others);
/// Adds the frames of a JSON file; returns false where it has none.
bool ReadJson(const JsonValue& root, CameraBuilder& builder, OtherClasses& others);
/// Whether JSON is the list of people of one frame.
bool IsFrame(const JsonValue& root);

}  // namespace ultralytics

}  // namespace canonpose
