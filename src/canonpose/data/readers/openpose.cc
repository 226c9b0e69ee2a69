#include "canonpose/data/readers/openpose.h"

#include <algorithm>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderAdvice =
    "give the folder that OpenPose's write_json option wrote, or the folder above several of those";

bool IsEmptyFolder(const fs::path& folder) {
  std::error_code error;
  return fs::is_empty(folder, error) && !error;
}

/// Whether a file is one frame and not, for instance, a calibration.
bool IsFrameFile(const fs::path& file) {
  if (!LastNumber(file.filename().string()) || FirstCharacter(file) != '{') return false;
  return JsonValue::Load(file).Has("people");
}

bool HasFrames(const std::vector<fs::path>& files) { return std::any_of(files.begin(), files.end(), IsFrameFile); }

/// The first folder below that contains frames; empty if there is none.
fs::path FolderOfFramesBelow(const fs::path& folder, int levels) {
  for (const fs::path& inner : FoldersIn(folder)) {
    if (HasFrames(JsonFilesIn(inner))) return inner;
    if (levels == 1) continue;
    if (fs::path below = FolderOfFramesBelow(inner, levels - 1); !below.empty()) return below;
  }
  return {};
}

/// Throws where a folder beside those of cameras is empty or has frames only in its sub-folders, since it would be
/// ignored.
void RefuseLeftOut(const fs::path& folder) {
  if (IsEmptyFolder(folder)) {
    ThrowBadInput({folder.string(), "", "one JSON file per frame", "an empty folder",
                   "remove it, or run the detector on that camera again"});
  }
  constexpr int kLevels = 3;
  if (const fs::path below = FolderOfFramesBelow(folder, kLevels); !below.empty()) {
    ThrowBadInput({folder.string(), "", "one JSON file per frame, as in the folders beside it",
                   "frames only below it, in " + below.string(),
                   fmt::format("move them up, or add `camera` {}={}", folder.filename().string(), below.string())});
  }
}

/// The body keypoints of one entry of `people`; an empty array if the detector ran with the body switched off.
std::vector<double> BodyTriples(const JsonValue& person) {
  // Versions before 1.2 wrote the shorter name.
  const std::optional<JsonValue> old_name = person.Find("pose_keypoints");
  const JsonValue value = old_name && !person.Has("pose_keypoints_2d") ? *old_name : person["pose_keypoints_2d"];
  std::vector<double> triples = value.Numbers();
  if (triples.size() % 3 != 0) {
    value.Fail("a multiple of three values (x, y, confidence)", "export the frame again",
               fmt::format("{} values", triples.size()));
  }
  return triples;
}

void ReadFrame(const fs::path& path, CameraBuilder& builder) {
  const JsonValue root = JsonValue::Load(path);
  const std::string& file = root.file();
  if (!root.Has("people")) root.Fail("an object with people", AdviseFormat(root));
  const JsonValue people = root["people"];
  const std::size_t count = people.ArraySize();
  const std::string name = path.filename().string();
  DetectedFrame& frame = builder.Frame(FrameNumberOf(name, file, ""), name, file, "");
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = people.At(i);
    std::optional<DetectedPerson> person = PersonFromTriples(BodyTriples(entry));
    if (!person) continue;
    // An undetected person_id is [-1].
    if (const std::optional<JsonValue> ids = entry.Find("person_id");
        ids && ids->json().is_array() && ids->ArraySize() > 0) {
      const std::int64_t id = ids->At(0).Integer();
      if (id >= 0) person->track_id = id;
    }
    builder.Add(frame, std::move(*person), file, entry.place() + ".pose_keypoints_2d");
  }
}

}  // namespace

std::vector<CameraInput> FindOpenPoseCameras(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    ThrowBadInput({path.string(), "", "a folder with one JSON file per frame", "a file", kFolderAdvice});
  }
  const std::vector<fs::path> files = JsonFilesIn(path);  // throws where there is no such folder
  std::vector<CameraInput> cameras;
  std::vector<fs::path> others;
  for (const fs::path& folder : FoldersIn(path)) {
    if (JsonFilesIn(folder).empty()) {
      others.push_back(folder);
    } else {
      cameras.push_back({CameraNameOf(folder), folder});
    }
  }
  if (!cameras.empty()) {
    if (HasFrames(files)) {
      ThrowBadInput({path.string(), "", "frames, or a sub-folder of frames for each camera",
                     fmt::format("both: frames, and sub-folder {} with JSON files", cameras.front().name),
                     "move one of them elsewhere, or name each camera's folder with `camera` NAME=PATH"});
    }
    for (const fs::path& folder : others) RefuseLeftOut(folder);
    return cameras;
  }
  if (files.empty()) {
    ThrowBadInput({path.string(), "", "one JSON file per frame, or a sub-folder of these for each camera",
                   IsEmptyFolder(path) ? "an empty folder" : "no JSON file", kFolderAdvice});
  }
  return {{CameraNameOf(path), path}};
}

DetectedCamera ReadOpenPose(const CameraInput& input) {
  const std::vector<fs::path> files = JsonFilesIn(input.path);
  if (files.empty()) {
    ThrowBadInput({input.path.string(), "", "one JSON file per frame", "no JSON file", kFolderAdvice});
  }
  CameraBuilder builder(input);
  Progress progress("reading " + input.name, std::ssize(files));
  long done = 0;
  for (const fs::path& file : files) {
    ReadFrame(file, builder);
    progress.Update(++done, "");
  }
  // Images without people have files too, so a gap in the numbers is a lost file and is not filled.
  return builder.Finish(false);
}

}  // namespace canonpose
