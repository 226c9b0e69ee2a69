// MediaPipe's pose landmarks as people's scripts dump them: csv or JSON, 33 points a person, fractions of the image.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

class JsonValue;

/// The cameras of a path: a csv or JSON file, a folder with one per camera, or a folder of frames (JSON) for each.
/// Throws Error(kBadInput).
std::vector<CameraInput> FindMediapipeCameras(const std::filesystem::path& path);

/// Reads one camera, in the layout mediapipe-33.
/// - csv: a row per frame, with columns named after landmark and axis (x0, y0, z0, v0 or NOSE_x, ...), or without a
/// header;
///   or a row per landmark, with columns frame, landmark, x, y. A column "frame" numbers the frames, otherwise the rows
///   do.
/// - JSON: a list of frames, an object of frames by number, or {frames: [...]}. A frame is a list of landmarks ({x, y,
///   z, visibility} or [x, y, z, visibility]), several such lists, an object with one in pose_landmarks, landmarks or
///   keypoints, or null. pose_world_landmarks, which are metres, are not read.
/// Visibility is the confidence; without it, that is 1. Landmarks at (0, 0) are missing, and so are those outside the
/// image, where the network guesses; how many is reported. Where most coordinates are far above 1, they are pixels.
/// Throws Error(kBadInput).
DetectedCamera ReadMediapipe(const CameraInput& input);

/// Whether JSON looks like such a dump.
bool LooksLikeMediapipe(const JsonValue& root);

namespace mediapipe {

/// Adds the frames of a csv file.
void ReadText(const std::filesystem::path& path, CameraBuilder& builder);
/// Adds the frames of a JSON file; returns false where it has none.
bool ReadJson(const JsonValue& root, CameraBuilder& builder);
/// Whether JSON is one frame.
bool IsFrame(const JsonValue& root);
/// Whether it is one in a form that no other detector's files have.
bool IsTypicalFrame(const JsonValue& root);

}  // namespace mediapipe

}  // namespace canonpose
