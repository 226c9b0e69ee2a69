#include "canonpose/data/readers/alphapose.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

bool IsFrame(const JsonValue& value) { return value.Has("people") || value.Has("bodies"); }

bool IsFrameFileOfAlphaPose(const fs::path& file) {
  return FirstCharacter(file) == '{' && IsFrame(JsonValue::Load(file));
}

/// people[].pose_keypoints_2d of the form "open", bodies[].joints of the form "cmu".
void ReadFrame(const JsonValue& value, const std::string& image, CameraBuilder& builder) {
  const bool is_open = value.Has("people");
  const JsonValue people = value[is_open ? "people" : "bodies"];
  const std::size_t count = people.ArraySize();
  DetectedFrame& frame =
      builder.Frame(FrameNumberOf(image, value.file(), value.place()), image, value.file(), value.place());
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue keypoints = people.At(i)[is_open ? "pose_keypoints_2d" : "joints"];
    std::optional<DetectedPerson> person = PersonFromTriples(Triples(keypoints));
    if (person) builder.Add(frame, std::move(*person), keypoints.file(), keypoints.place());
  }
}

void ReadAlphaPoseFile(const fs::path& path, CameraBuilder& builder) {
  const JsonValue root = JsonValue::Load(path);
  if (root.json().is_array()) {
    ReadFlatList(root, builder);
  } else if (root.json().is_object() && IsFrame(root)) {
    ReadFrame(root, path.filename().string(), builder);
  } else {
    if (!root.json().is_object()) root.Fail("AlphaPose's list or object of detections");
    for (const std::string& image : root.Keys()) {
      const JsonValue frame = root[image];
      if (!IsFrame(frame)) frame.Fail("an object with people or bodies", AdviseFormat(root));
      ReadFrame(frame, image, builder);
    }
  }
}

}  // namespace

std::vector<CameraInput> FindAlphaPoseCameras(const fs::path& path) {
  return FindFileCameras(path, IsFrameFileOfAlphaPose);
}

DetectedCamera ReadAlphaPose(const CameraInput& input) {
  CameraBuilder builder(input);
  std::error_code error;
  if (!fs::is_directory(input.path, error)) {
    ReadAlphaPoseFile(input.path, builder);
    return builder.Finish(true);
  }
  const std::vector<fs::path> files = JsonFilesIn(input.path);
  Progress progress("reading " + input.name, std::ssize(files));
  long done = 0;
  for (const fs::path& file : files) {
    ReadAlphaPoseFile(file, builder);
    progress.Update(++done, "");
  }
  return builder.Finish(true);
}

}  // namespace canonpose
