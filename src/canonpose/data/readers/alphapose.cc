#include "canonpose/data/readers/alphapose.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

bool IsFrame(const JsonValue& value) { return value.Contains("people") || value.Contains("bodies"); }

bool IsFrameFileOfAlphaPose(const fs::path& file) {
  return FirstCharacter(file) == '{' && IsFrame(JsonValue::Load(file));
}

/// people[].pose_keypoints_2d of the form "open", bodies[].joints of the form "cmu".
void ReadFrame(const JsonValue& value, const std::string& image, CameraBuilder& builder) {
  const bool is_open = value.Contains("people");
  DetectedFrame& frame = builder.Frame(image, value.file(), value.place());
  const JsonValue people = value[is_open ? "people" : "bodies"];
  if (people.IsNull()) return;
  const std::size_t count = people.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue keypoints = people.At(i)[is_open ? "pose_keypoints_2d" : "joints"];
    if (keypoints.IsNull()) continue;
    const std::vector<double> triples = Triples(keypoints);
    builder.NoteKeypointCount(triples.size() / 3);
    std::optional<DetectedPerson> person = PersonFromTriples(triples);
    if (person) builder.Add(frame, std::move(*person), keypoints.file(), keypoints.place());
  }
}

/// Returns false where the file has no keypoints.
bool ReadAlphaPoseFile(const JsonValue& root, CameraBuilder& builder) {
  if (root.json().is_object() && IsFrame(root)) {
    ReadFrame(root, fs::path(root.file()).filename().string(), builder);
    return true;
  }
  if (GuessFormat(root).empty() && !root.json().empty()) return false;
  if (root.json().is_array()) {
    ReadFlatList(root, builder);
    return true;
  }
  if (!root.json().is_object()) FailFormat(root, "AlphaPose's list or object of detections");
  for (const std::string& image : root.Keys()) {
    const JsonValue frame = root[image];
    if (!IsFrame(frame)) FailFormat(root, "AlphaPose's frames, objects with people or bodies");
    ReadFrame(frame, image, builder);
  }
  return true;
}

}  // namespace

std::vector<CameraInput> FindAlphaPoseCameras(const fs::path& path) {
  return FindFileCameras(path, IsFrameFileOfAlphaPose);
}

DetectedCamera ReadAlphaPose(const CameraInput& input) {
  CameraBuilder builder(input);
  std::error_code error;
  constexpr const char* kExpected = "AlphaPose's list or object of detections";
  if (fs::is_directory(input.path, error)) {
    ReadFrameFiles(input, builder, ReadAlphaPoseFile, kExpected);
  } else {
    const JsonValue root = JsonValue::Load(input.path);
    if (!ReadAlphaPoseFile(root, builder)) FailFormat(root, kExpected);
  }
  return builder.Finish(true);
}

}  // namespace canonpose
