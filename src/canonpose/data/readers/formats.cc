#include "canonpose/data/readers/formats.h"

#include <algorithm>
#include <system_error>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/alphapose.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/data/readers/coco.h"
#include "canonpose/data/readers/mmpose.h"
#include "canonpose/data/readers/openpose.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

std::string GuessList(const JsonValue& list) {
  if (list.ArraySize() == 0) return "";
  const JsonValue first = list.At(0);
  if (first.Has("instances") || first.Has("keypoint_scores")) return "mmpose";
  if (!first.Has("image_id") || !first.Has("keypoints")) return "";
  return first["image_id"].json().is_string() ? "alphapose" : "coco";
}

/// How many files of a folder are examined; other files, such as a calibration, may come before the detections.
constexpr std::size_t kFilesToTry = 10;

std::string GuessFolder(const fs::path& folder) {
  std::vector<fs::path> files = JsonFilesIn(folder);
  if (files.size() > kFilesToTry) files.resize(kFilesToTry);
  for (const fs::path& file : files) {
    std::string format = GuessFormat(JsonValue::Load(file));
    if (!format.empty()) return format;
  }
  return "";
}

/// The path may contain camera folders, and each of these a folder of frames.
std::string GuessPath(const fs::path& path, int levels_below) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return GuessFormat(JsonValue::Load(path));
  std::string format = GuessFolder(path);
  if (!format.empty() || levels_below == 0) return format;
  for (const fs::path& inner : FoldersIn(path)) {
    format = GuessPath(inner, levels_below - 1);
    if (!format.empty()) break;
  }
  return format;
}

}  // namespace

const std::vector<DetectionFormat>& DetectionFormats() {
  static const std::vector<DetectionFormat> formats = {{"openpose", FindOpenPoseCameras, ReadOpenPose},
                                                       {"alphapose", FindAlphaPoseCameras, ReadAlphaPose},
                                                       {"mmpose", FindMmposeCameras, ReadMmpose},
                                                       {"coco", FindCocoCameras, ReadCoco}};
  return formats;
}

const DetectionFormat& FindDetectionFormat(std::string_view name) {
  for (const DetectionFormat& format : DetectionFormats()) {
    if (SameName(format.name, name)) return format;
  }
  ThrowInvalidArgument("there is no format \"{}\"; the formats are {}, and the benchmarks are {}", name,
                       DetectionFormatNames(), BenchmarkFormatNames());
}

std::string DetectionFormatNames() {
  std::string names;
  for (const DetectionFormat& format : DetectionFormats()) names.append(names.empty() ? "" : ", ").append(format.name);
  return names;
}

std::string GuessFormat(const JsonValue& root) {
  if (root.json().is_array()) return GuessList(root);
  if (!root.json().is_object()) return "";
  if (root.Has("instance_info")) return "mmpose";
  if (root.Has("bodies")) return "alphapose";
  if (root.Has("people")) {
    // AlphaPose imitates OpenPose, with a string where OpenPose has a number.
    const std::optional<JsonValue> version = root.Find("version");
    return version && version->json().is_string() ? "alphapose" : "openpose";
  }
  const std::vector<std::string> keys = root.Keys();
  if (keys.empty()) return "";
  const JsonValue first = root[keys.front()];
  return first.Has("people") || first.Has("bodies") ? "alphapose" : "";
}

std::string DetectFormat(const fs::path& path) {
  std::string format = GuessPath(path, 2);
  if (format.empty()) {
    ThrowBadInput({path.string(), "", "keypoints of " + DetectionFormatNames(), "none of these", "check the path"});
  }
  return format;
}

}  // namespace canonpose
