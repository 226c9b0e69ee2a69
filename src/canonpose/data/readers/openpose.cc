#include "canonpose/data/readers/openpose.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/formats.h"
#include "canonpose/data/readers/frame_numbers.h"
#include "canonpose/data/readers/video_facts.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolderAdvice =
    "give the folder that OpenPose's write_json option wrote, or the folder above several of those";

/// What OpenPose finds beside the body.
constexpr std::array<std::pair<const char*, const char*>, 3> kOtherOpenPoseParts{
    {{"face_keypoints_2d", "face"}, {"hand_left_keypoints_2d", "hands"}, {"hand_right_keypoints_2d", "hands"}}};

bool IsEmptyFolder(const fs::path& folder) {
  std::error_code error;
  return fs::is_empty(folder, error) && !error;
}

/// Whether a file is one frame and not, for instance, a calibration.
bool IsFrameFile(const fs::path& file) {
  if (!LastNumber(file.filename().string()) || FirstCharacter(file) != '{') return false;
  return JsonValue::Load(file).Contains("people");
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

/// The body keypoints of one entry of `people`; an empty array if the detector ran with the body switched off, or if
/// the entry is empty, as tools write people whom they did not find.
std::vector<double> BodyTriples(const JsonValue& person) {
  if (person.IsNull()) return {};
  // Versions before 1.2 wrote the shorter name.
  const char* const name = !person.Contains("pose_keypoints_2d") && person.Contains("pose_keypoints")
                               ? "pose_keypoints"
                               : "pose_keypoints_2d";
  if (!person.Contains(name)) {
    const std::vector<std::string> keys = person.Keys();
    const bool has_keypoints = std::any_of(
        keys.begin(), keys.end(), [](const std::string& key) { return key.find("keypoints") != std::string::npos; });
    if (!has_keypoints) return {};
  }
  const JsonValue value = person[name];
  if (value.IsNull()) return {};
  std::vector<double> triples = value.NumbersOrNaN();
  if (triples.size() % 3 != 0) {
    value.Fail("a multiple of three values (x, y, confidence)", "export the frame again",
               fmt::format("{} values", triples.size()));
  }
  return triples;
}

void NoteUnusedParts(const JsonValue& person, CameraBuilder& builder) {
  for (const auto& [key, part] : kOtherOpenPoseParts) {
    const std::optional<JsonValue> values = person.Find(key);
    if (values && values->json().is_array() && !values->json().empty()) builder.NoteUnusedPart(part);
  }
}

/// Returns false where the file is neither a frame nor what `detect` says of the video.
bool ReadFrame(const JsonValue& root, CameraBuilder& builder) {
  const std::string& file = root.file();
  if (!root.Contains("people")) return fs::path(file).filename() == kVideoFactsFile;  // which import reads by itself
  DetectedFrame& frame = builder.Frame(fs::path(file).filename().string(), file, "");
  const JsonValue people = root["people"];
  if (people.IsNull()) return true;
  const std::size_t count = people.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = people.At(i);
    const std::vector<double> triples = BodyTriples(entry);
    builder.NoteKeypointCount(triples.size() / 3);
    NoteUnusedParts(entry, builder);
    std::optional<DetectedPerson> person = PersonFromTriples(triples);
    if (!person) continue;
    // An undetected person_id is [-1].
    if (const std::optional<JsonValue> ids = entry.Find("person_id");
        ids && ids->json().is_array() && !ids->json().empty() && ids->At(0).json().is_number()) {
      const std::int64_t id = ids->At(0).Integer();
      if (id >= 0) person->track_id = id;
    }
    builder.Add(frame, std::move(*person), file, entry.place() + ".pose_keypoints_2d");
  }
  return true;
}

/// Where some folders have frames, those that have none are no cameras, unless they have detections in another form.
void LeaveOutFoldersWithoutFrames(std::vector<CameraInput>& cameras) {
  std::vector<fs::path> without;
  for (const CameraInput& camera : cameras) {
    if (!HasFrames(JsonFilesIn(camera.path))) without.push_back(camera.path);
  }
  if (without.size() == cameras.size()) return;
  std::erase_if(without, [](const fs::path& folder) { return HasDetections(folder); });
  if (without.empty()) return;
  LogWarning("{} left out: {}",
             without.size() == 1 ? "a folder has no keypoints and is"
                                 : fmt::format("{} folders have no keypoints and are", without.size()),
             FirstAndCount(without));
  std::erase_if(cameras, [&](const CameraInput& camera) {
    return std::find(without.begin(), without.end(), camera.path) != without.end();
  });
}

}  // namespace

std::vector<CameraInput> FindOpenPoseCameras(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    const std::string kind = KindOfFile(path);
    ThrowBadInput({path.string(), "", "a folder with one JSON file per frame", kind.empty() ? "a file" : kind,
                   kind.empty() ? kFolderAdvice : AdviceForKind(kind)});
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
    LeaveOutFoldersWithoutFrames(cameras);
    return cameras;
  }
  if (files.empty()) {
    ThrowBadInput({path.string(), "", "one JSON file per frame, or a sub-folder of these for each camera",
                   DescribeFolder(path), AdviseFolder(path, kFolderAdvice)});
  }
  // Videos beside, say, a calibration.
  if (const std::string found = DescribeFolder(path); found != kNoJsonFile && !HasFrames(files)) {
    ThrowBadInput({path.string(), "", "one JSON file per frame, or a sub-folder of these for each camera", found,
                   AdviseFolder(path, kFolderAdvice)});
  }
  return {{CameraNameOf(path), path}};
}

DetectedCamera ReadOpenPose(const CameraInput& input) {
  if (JsonFilesIn(input.path).empty()) {
    ThrowBadInput({input.path.string(), "", "one JSON file per frame", DescribeFolder(input.path),
                   AdviseFolder(input.path, kFolderAdvice)});
  }
  CameraBuilder builder(input);
  ReadFrameFiles(input, builder, ReadFrame, "an object with people");
  // Images without people have files too, so a gap in the numbers is a lost file and is not filled.
  DetectedCamera camera = builder.Finish(false);
  camera.has_tracks = ReadVideoFacts(input.path).has_value();
  return camera;
}

}  // namespace canonpose
