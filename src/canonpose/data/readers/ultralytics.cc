#include "canonpose/data/readers/ultralytics.h"

#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/camera_files.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/frame_numbers.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ultralytics::OtherClasses;

constexpr const char* kLabelsAdvice =
    "give the folder labels that Ultralytics' save_txt option writes for a video, or results saved as JSON";
/// One folder may have the frames of so many videos.
constexpr std::size_t kMostVideos = 64;

/// The text files of a folder that are frames: they have a number in their names.
std::vector<fs::path> FramesIn(const fs::path& folder) {
  std::vector<fs::path> files = FilesIn(folder, {".txt"});
  std::erase_if(files, [](const fs::path& file) { return !LastNumber(file.filename().string()); });
  return files;
}

/// What comes before the last number of a name: "cam1" of "cam1_12.txt".
std::string VideoOf(const fs::path& file) {
  std::string name = file.stem().string();
  name.resize(name.find_last_of("0123456789") + 1);
  while (!name.empty() && name.back() >= '0' && name.back() <= '9') name.pop_back();
  while (!name.empty() && (name.back() == '_' || name.back() == '-' || name.back() == '.')) name.pop_back();
  return name;
}

/// The videos that a folder has frames of; one, without a name, where names say nothing of several.
std::vector<std::string> VideosOf(const std::vector<fs::path>& files) {
  std::map<std::string, std::size_t> counts;
  for (const fs::path& file : files) ++counts[VideoOf(file)];
  const bool are_names = counts.size() > 1 && counts.size() <= kMostVideos &&
                         std::all_of(counts.begin(), counts.end(),
                                     [](const auto& video) { return !video.first.empty() && video.second > 1; });
  if (!are_names) return {""};
  std::vector<std::string> videos;
  for (const auto& [video, count] : counts) videos.push_back(video);
  return videos;
}

/// The cameras of a folder of text files; none where it has no frames.
std::vector<CameraInput> TextCamerasIn(const fs::path& folder) {
  const std::vector<fs::path> files = FramesIn(folder);
  if (files.empty()) {
    std::error_code error;
    const fs::path labels = folder / "labels";
    return fs::is_directory(labels, error) ? TextCamerasIn(labels) : std::vector<CameraInput>();
  }
  std::vector<CameraInput> cameras;
  for (const std::string& video : VideosOf(files))
    cameras.push_back({video.empty() ? CameraNameOf(folder) : video, folder, video});
  return cameras;
}

bool IsJsonFrame(const fs::path& file) {
  const char first = FirstCharacter(file);
  if (!LastNumber(file.filename().string()) || (first != '[' && first != '{')) return false;
  const JsonValue root = JsonValue::Load(file);
  return (root.json().is_array() && root.json().empty()) || ultralytics::IsFrame(root);
}

void ReportOthers(const OtherClasses& others, const CameraInput& input, bool has_people) {
  if (others.empty()) return;
  std::string classes;
  std::size_t total = 0;
  for (const auto& [number, count] : others) {
    classes += fmt::format("{}{}", classes.empty() ? "" : ", ", number);
    total += count;
  }
  if (!has_people) {
    ThrowBadInput({input.path.string(), "", "people, class 0", fmt::format("classes {}", classes),
                   "use a pose model of people, or keep only the class that you want, as class 0"});
  }
  LogWarning("{}: {} detections of class {} are left out; only people (class 0) are read", input.name, total, classes);
}

bool HasPeople(const DetectedCamera& camera) {
  return std::any_of(camera.frames.begin(), camera.frames.end(),
                     [](const auto& frame) { return !frame.people.empty(); });
}

}  // namespace

std::vector<CameraInput> FindUltralyticsCameras(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    std::vector<CameraInput> cameras = TextCamerasIn(path);
    if (!cameras.empty()) return cameras;
    for (const fs::path& folder : FoldersIn(path)) {
      for (CameraInput& camera : TextCamerasIn(folder)) cameras.push_back(std::move(camera));
    }
    if (!cameras.empty()) return cameras;
    if (!FilesIn(path, {".txt"}).empty() && JsonFilesIn(path).empty()) {
      ThrowBadInput({path.string(), "", "a text file per frame, with the frame's number in its name",
                     FirstAndCount(FilesIn(path, {".txt"})), kLabelsAdvice});
    }
  } else if (path.extension() == ".txt") {
    ThrowBadInput({path.string(), "", "a folder with a text file per frame", "one text file", kLabelsAdvice});
  }
  return FindFileCameras(path, IsJsonFrame);
}

DetectedCamera ReadUltralytics(const CameraInput& input) {
  CameraBuilder builder(input);
  OtherClasses others;
  std::error_code error;
  const bool is_folder = fs::is_directory(input.path, error);
  std::vector<fs::path> texts = is_folder ? FramesIn(input.path) : std::vector<fs::path>();
  constexpr const char* kExpected = "Ultralytics' lists of people with keypoints";
  if (!texts.empty()) {
    if (!input.part.empty()) std::erase_if(texts, [&](const fs::path& file) { return VideoOf(file) != input.part; });
    ultralytics::ReadText(texts, input.keypoint_count, builder, others);
  } else if (is_folder) {
    for (const fs::path& file : JsonFilesIn(input.path)) {
      if (!ultralytics::ReadJson(JsonValue::Load(file), builder, others)) builder.LeaveOut(file);
    }
  } else {
    const JsonValue root = JsonValue::Load(input.path);
    if (!ultralytics::ReadJson(root, builder, others)) FailFormat(root, kExpected);
  }
  // Of a recording with other classes alone, Finish() would say that nobody is in it.
  if (!builder.has_people()) ReportOthers(others, input, false);
  DetectedCamera camera = builder.Finish(true);
  ReportOthers(others, input, HasPeople(camera));
  if (LargestCoordinate(camera) <= kLargestImageFraction) {
    FractionsToPixels(camera, input.image_size);
  } else if (!texts.empty()) {
    ThrowBadInput({input.path.string(), "", "keypoints as fractions of the image, as save_txt writes them",
                   fmt::format("coordinates up to {:.6g}", LargestCoordinate(camera)), kLabelsAdvice});
  }
  return camera;
}

bool LooksLikeUltralytics(const JsonValue& root) {
  if (ultralytics::IsFrame(root)) return true;
  constexpr std::size_t kFramesToTry = 1000;
  if (root.json().is_array()) {
    for (std::size_t i = 0; i < std::min(root.ArraySize(), kFramesToTry); ++i) {
      if (ultralytics::IsFrame(root.At(i))) return true;
    }
    return false;
  }
  if (!root.json().is_object()) return false;
  const std::vector<std::string> keys = root.Keys();
  return std::any_of(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(std::min(keys.size(), kFramesToTry)),
                     [&](const std::string& key) { return ultralytics::IsFrame(root[key]); });
}

}  // namespace canonpose
