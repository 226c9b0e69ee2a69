#include "canonpose/data/readers/formats.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/alphapose.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/data/readers/coco.h"
#include "canonpose/data/readers/deeplabcut.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/frame_numbers.h"
#include "canonpose/data/readers/freemocap.h"
#include "canonpose/data/readers/mediapipe.h"
#include "canonpose/data/readers/mmpose.h"
#include "canonpose/data/readers/openpose.h"
#include "canonpose/data/readers/sleap.h"
#include "canonpose/data/readers/ultralytics.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Whether an object is a person as MMPose writes it.
bool IsInstance(const JsonValue& value) {
  if (value.Has("keypoint_scores")) return true;
  const std::optional<JsonValue> keypoints = value.Find("keypoints");
  return keypoints && !value.Has("image_id") && keypoints->json().is_array() && !keypoints->json().empty() &&
         keypoints->At(0).json().is_array();
}

std::string GuessList(const JsonValue& list) {
  for (std::size_t i = 0; i < list.ArraySize(); ++i) {
    const JsonValue entry = list.At(i);
    if (entry.json().is_array()) {
      if (entry.json().empty()) continue;  // a frame without people
      return IsInstance(entry.At(0)) ? "mmpose" : "";
    }
    if (entry.Has("instances") || entry.Has("predictions") || IsInstance(entry)) return "mmpose";
    if (!entry.Has("image_id") || !entry.Contains("keypoints")) return "";
    return entry["image_id"].json().is_string() ? "alphapose" : "coco";
  }
  return "";
}

/// The formats that are recognised by the first entry.
std::string GuessUsual(const JsonValue& root) {
  if (root.json().is_array()) return GuessList(root);
  if (!root.json().is_object()) return "";
  if (root.Has("instance_info") || root.Has("predictions")) return LooksLikeUltralytics(root) ? "" : "mmpose";
  if (root.Has("bodies")) return "alphapose";
  if (root.Contains("people")) {
    if (LooksLikeUltralytics(root)) return "";
    // AlphaPose imitates OpenPose, with a string where OpenPose has a number.
    const std::optional<JsonValue> version = root.Find("version");
    return version && version->json().is_string() ? "alphapose" : "openpose";
  }
  const std::vector<std::string> keys = root.Keys();
  if (keys.empty()) return "";
  const JsonValue first = root[keys.front()];
  return first.Has("people") || first.Has("bodies") ? "alphapose" : "";
}

/// How many files of a folder are examined; other files, such as a calibration, may come before the detections.
constexpr std::size_t kFilesToGuessFrom = 10;

std::string GuessFolder(const fs::path& folder) {
  std::vector<fs::path> files = JsonFilesIn(folder);
  if (files.size() > kFilesToGuessFrom) files.resize(kFilesToGuessFrom);
  for (const fs::path& file : files) {
    std::string format = GuessFormat(JsonValue::Load(file));
    if (!format.empty()) return format;
  }
  return "";
}

/// The format of a file that is not JSON; empty where it is none.
std::string GuessOtherFile(const fs::path& file) {
  const std::string extension = LowerCase(file.extension().string());
  if (extension == ".npy") return IsFreemocapFile(file) ? "freemocap" : "";
  if (IsSleapFile(file)) return "sleap";
  if (IsDeepLabCutFile(file)) return "deeplabcut";
  return extension == ".csv" ? "mediapipe" : "";
}

/// The format of a folder's files that are not JSON.
std::string GuessOtherFolder(const fs::path& folder) {
  std::vector<fs::path> files = FilesIn(folder, {".csv", ".h5", ".hdf5", ".npy"});
  if (files.size() > kFilesToGuessFrom) files.resize(kFilesToGuessFrom);
  for (const fs::path& file : files) {
    if (std::string format = GuessOtherFile(file); !format.empty()) return format;
  }
  const std::vector<fs::path> texts = FilesIn(folder, {".txt"});
  const bool are_frames = std::any_of(texts.begin(), texts.end(), [](const fs::path& file) {
    return LastNumber(file.filename().string()).has_value();
  });
  return are_frames ? "ultralytics" : "";
}

/// The path may contain camera folders, and each of these a folder of frames.
std::string GuessPath(const fs::path& path, int levels_below) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    std::string format = GuessOtherFile(path);
    return format.empty() ? GuessFormat(JsonValue::Load(path)) : format;
  }
  std::string format = GuessFolder(path);
  if (format.empty()) format = GuessOtherFolder(path);
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
                                                       {"coco", FindCocoCameras, ReadCoco},
                                                       {"deeplabcut", FindDeepLabCutCameras, ReadDeepLabCut},
                                                       {"sleap", FindSleapCameras, ReadSleap},
                                                       {"mediapipe", FindMediapipeCameras, ReadMediapipe},
                                                       {"ultralytics", FindUltralyticsCameras, ReadUltralytics},
                                                       {"freemocap", FindFreemocapCameras, ReadFreemocap}};
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

std::string LooksLikeFormat(const fs::path& path) {
  try {
    return GuessPath(path, 2);
  } catch (const Error&) {
    return "";
  }
}

bool HasDetections(const fs::path& folder) { return !GuessFolder(folder).empty(); }

std::string GuessFormat(const JsonValue& root) {
  const std::string format = GuessUsual(root);
  if (!format.empty()) return format;
  if (LooksLikeMediapipe(root)) return "mediapipe";
  return LooksLikeUltralytics(root) ? "ultralytics" : "";
}

std::string DescribeContent(const JsonValue& root) {
  const auto count = [&](const char* key) -> std::optional<std::size_t> {
    const std::optional<JsonValue> list = root.Find(key);
    if (!list || !list->json().is_array()) return std::nullopt;
    return list->ArraySize();
  };
  const auto images = count("images");
  const auto annotations = count("annotations");
  const auto categories = count("categories");
  if (images && (annotations || categories)) {
    std::string text = fmt::format("a COCO dataset with {} image{}", *images, *images == 1 ? "" : "s");
    if (annotations) text += fmt::format(", {} annotation{}", *annotations, *annotations == 1 ? "" : "s");
    if (categories) {
      text += fmt::format("{}{} categor{}", annotations ? " and " : ", ", *categories, *categories == 1 ? "y" : "ies");
    }
    return text;
  }
  if (const std::optional<JsonValue> cameras = root.Find("cameras")) {
    return cameras->json().is_object() ? fmt::format("a calibration of cameras {}", fmt::join(cameras->Keys(), ", "))
                                       : "a description of cameras";
  }
  return root.DescribeStructure();
}

std::string AdviceForContent(const JsonValue& root) {
  if (root.Has("images") || root.Has("annotations")) {
    return "this is an annotation file; its third value is a visibility, not a confidence; give the results that a "
           "detector writes for it, a list of objects with image_id, category_id, keypoints and score";
  }
  if (root.Has("cameras")) return "give it as `calibration`, and here the keypoints of each camera";
  return fmt::format("give the files that a 2D keypoint detector writes ({})", DetectionFormatNames());
}

std::string DetectFormat(const fs::path& path) {
  std::string format = GuessPath(path, 2);
  if (format.empty()) {
    std::error_code error;
    const std::string expected = "keypoints of " + DetectionFormatNames();
    if (!fs::is_directory(path, error)) FailFormat(JsonValue::Load(path), expected);
    std::string found = DescribeFolder(path);
    if (found == kNoJsonFile) found = "none of these";
    ThrowBadInput({path.string(), "", expected, found, AdviseFolder(path, "check the path")});
  }
  return format;
}

}  // namespace canonpose
