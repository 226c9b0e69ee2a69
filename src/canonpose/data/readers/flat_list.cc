#include "canonpose/data/readers/flat_list.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// A track id: a number, or, as some trackers write it, a number in an array.
std::optional<std::int64_t> TrackId(const JsonValue& entry) {
  for (const char* key : {"idx", "track_id"}) {
    std::optional<JsonValue> value = entry.Find(key);
    while (value && value->json().is_array() && value->ArraySize() > 0) value = value->At(0);
    if (value && value->json().is_number()) {
      const double id = value->Number();
      if (id >= 0) return static_cast<std::int64_t>(id);
    }
  }
  return std::nullopt;
}

bool IsCalibration(const fs::path& file) {
  if (FirstCharacter(file) != '{') return false;
  const std::optional<JsonValue> cameras = JsonValue::Load(file).Find("cameras");
  return cameras && cameras->json().is_object();
}

std::vector<CameraInput> CamerasInFolder(const fs::path& folder, IsFrameFile is_frame_file) {
  std::vector<fs::path> files = JsonFilesIn(folder);
  // If the first file is a frame, so are the others, of which there may be thousands.
  if (!files.empty() && is_frame_file(files.front())) return {{CameraNameOf(folder), folder}};
  std::erase_if(files, IsCalibration);
  if (!files.empty() && is_frame_file(files.front())) return {{CameraNameOf(folder), folder}};
  std::vector<CameraInput> cameras;
  cameras.reserve(files.size());
  for (const fs::path& file : files) cameras.push_back({CameraNameOf(file), file});
  return cameras;
}

}  // namespace

std::vector<double> Triples(const JsonValue& value) {
  std::vector<double> triples = value.Numbers();
  if (triples.empty() || triples.size() % 3 != 0) {
    value.Fail("a multiple of three values (x, y, confidence)", "export it again",
               fmt::format("{} values", triples.size()));
  }
  return triples;
}

void ReadFlatList(const JsonValue& list, CameraBuilder& builder) {
  const std::size_t count = list.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = list.At(i);
    if (!entry.Has("image_id") || !entry.Has("keypoints")) {
      entry.Fail("an object with image_id and keypoints", AdviseFormat(list));
    }
    const JsonValue image = entry["image_id"];
    std::string name;
    std::int64_t number = 0;
    if (image.json().is_string()) {
      name = image.String();
      number = FrameNumberOf(name, image.file(), image.place());
    } else {
      number = image.Integer();
      name = fmt::format("{}", number);
    }
    DetectedFrame& frame = builder.Frame(number, name, image.file(), image.place());
    const JsonValue keypoints = entry["keypoints"];
    std::optional<DetectedPerson> person = PersonFromTriples(Triples(keypoints));
    if (!person) continue;
    person->track_id = TrackId(entry);
    if (const std::optional<JsonValue> score = entry.Find("score"); score && score->json().is_number()) {
      person->score = score->Number();
    }
    builder.Add(frame, std::move(*person), keypoints.file(), keypoints.place());
  }
}

std::vector<CameraInput> FindFileCameras(const fs::path& path, IsFrameFile is_frame_file) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return {{CameraNameOf(path), path}};
  std::vector<CameraInput> cameras = CamerasInFolder(path, is_frame_file);
  if (!cameras.empty()) return cameras;
  for (const fs::path& folder : FoldersIn(path)) {
    std::vector<CameraInput> inside = CamerasInFolder(folder, is_frame_file);
    // A camera's output folder may contain its frames in a sub-folder (sep-json).
    const std::vector<fs::path> inner = inside.empty() ? FoldersIn(folder) : std::vector<fs::path>();
    if (inner.size() == 1) inside = CamerasInFolder(inner.front(), is_frame_file);
    if (inside.size() > 1) {
      ThrowBadInput({folder.string(), "", "one camera in each sub-folder", fmt::format("{} files", inside.size()),
                     "name the cameras with `camera` NAME=PATH"});
    }
    if (!inside.empty()) cameras.push_back({CameraNameOf(folder), inside.front().path});
  }
  if (cameras.empty()) {
    const bool is_empty = fs::is_empty(path, error) && !error;
    ThrowBadInput({path.string(), "", "a JSON file for each camera", is_empty ? "an empty folder" : "no JSON file",
                   "check the path"});
  }
  return cameras;
}

std::string AdviseFormat(const JsonValue& root) {
  const std::string format = GuessFormat(root);
  return format.empty() ? "" : fmt::format("this looks like the format {}", format);
}

}  // namespace canonpose
