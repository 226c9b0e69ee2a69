#include "canonpose/data/readers/mediapipe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/camera_files.h"
#include "canonpose/data/readers/deeplabcut.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/frame_numbers.h"
#include "canonpose/data/readers/mediapipe_layout.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr float kNoPoint = std::numeric_limits<float>::quiet_NaN();
/// World landmarks have their origin between the hips; in an image those are never this near to its corner for long.
constexpr double kHipsAtOrigin = 0.02;

bool IsText(const fs::path& file) { return LowerCase(file.extension().string()) == ".csv"; }

bool HasText(const fs::path& folder) {
  const std::vector<fs::path> files = FilesIn(folder, {".csv"});
  return std::any_of(files.begin(), files.end(), [](const fs::path& file) { return !IsDeepLabCutFile(file); });
}

template <typename Action>
void ForEachPerson(DetectedCamera& camera, Action&& action) {
  for (DetectedFrame& frame : camera.frames) {
    for (DetectedPerson& person : frame.people) action(person);
  }
}

/// Throws where the points are metres around the hips.
void RefuseWorldLandmarks(DetectedCamera& camera) {
  const auto left = static_cast<std::size_t>(MediapipeLayout().Find("LHip").value());
  const auto right = static_cast<std::size_t>(MediapipeLayout().Find("RHip").value());
  std::vector<double> distances;
  ForEachPerson(camera, [&](const DetectedPerson& person) {
    const std::vector<float>& points = person.keypoints;
    const float distance =
        std::hypot(points[2 * left] + points[2 * right], points[2 * left + 1] + points[2 * right + 1]);
    if (!std::isnan(distance)) distances.push_back(0.5F * distance);
  });
  if (distances.empty() || Median(std::move(distances)) > kHipsAtOrigin) return;
  ThrowBadInput({camera.path, "", "landmarks in the image, as fractions of it",
                 "points around the middle of the hips, so world landmarks in metres",
                 "dump pose_landmarks, not pose_world_landmarks"});
}

/// Leaves out landmarks outside the image, which the network did not see, and people of whom nothing is left.
void DropOutside(DetectedCamera& camera) {
  std::size_t seen = 0;
  std::size_t outside = 0;
  ForEachPerson(camera, [&](DetectedPerson& person) {
    for (std::size_t k = 0; k < person.confidence.size(); ++k) {
      float* const point = &person.keypoints[2 * k];
      if (std::isnan(point[0])) continue;
      ++seen;
      if (point[0] >= 0.0F && point[0] <= 1.0F && point[1] >= 0.0F && point[1] <= 1.0F) continue;
      ++outside;
      point[0] = point[1] = kNoPoint;
      person.confidence[k] = 0.0F;
    }
  });
  for (DetectedFrame& frame : camera.frames) {
    std::erase_if(frame.people, [](const DetectedPerson& person) {
      return std::all_of(person.confidence.begin(), person.confidence.end(), [](float c) { return c == 0.0F; });
    });
  }
  if (outside == 0) return;
  LogInfo("{}: {:.1f} % of the landmarks lie outside the image, where MediaPipe guesses; they are left out",
          camera.name, 100.0 * static_cast<double>(outside) / static_cast<double>(seen));
  if (outside == seen) {
    ThrowBadInput({camera.path, "", "landmarks in the image, as fractions of it", "none between 0 and 1",
                   "dump x and y as MediaPipe gives them"});
  }
}

}  // namespace

std::vector<CameraInput> FindMediapipeCameras(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {{CameraNameOf(path), path}};
  const std::vector<fs::path> folders = FoldersIn(path);
  if (HasText(path) || std::any_of(folders.begin(), folders.end(), HasText)) {
    return FindCameraFiles(path, {{".csv"},
                                  "a csv file of landmarks for each camera",
                                  [](const fs::path& file) { return !IsDeepLabCutFile(file); },
                                  CameraNameOf});
  }
  return FindFileCameras(path, [](const fs::path& file) {
    const char first = FirstCharacter(file);
    if (first != '{' && first != '[') return false;
    const JsonValue root = JsonValue::Load(file);
    const bool is_nobody = root.json().is_array() && root.json().empty() && LastNumber(file.filename().string());
    return is_nobody || mediapipe::IsFrame(root);
  });
}

DetectedCamera ReadMediapipe(const CameraInput& input) {
  const std::string file = input.path.string();
  CameraBuilder builder(input);
  builder.SetLayout(DetectedMediapipeLayout(), file, "");
  constexpr const char* kExpected = "MediaPipe's landmarks, 33 for each person";
  std::error_code error;
  if (fs::is_directory(input.path, error)) {
    ReadFrameFiles(input, builder, mediapipe::ReadJson, kExpected);
  } else if (IsText(input.path)) {
    mediapipe::ReadText(input.path, builder);
  } else {
    const JsonValue root = JsonValue::Load(input.path);
    if (!mediapipe::ReadJson(root, builder)) FailFormat(root, kExpected);
  }
  // Many scripts write nothing for frames without a person.
  DetectedCamera camera = builder.Finish(true);
  RefuseWorldLandmarks(camera);
  std::vector<double> sizes;
  ForEachPerson(camera, [&](const DetectedPerson& person) {
    for (const float coordinate : person.keypoints) {
      if (!std::isnan(coordinate)) sizes.push_back(std::abs(coordinate));
    }
  });
  if (Median(std::move(sizes)) > kLargestImageFraction) {
    LogInfo("{}: the landmarks are pixels, not fractions of the image", camera.name);
    return camera;
  }
  DropOutside(camera);
  FractionsToPixels(camera, input.image_size);
  return camera;
}

bool LooksLikeMediapipe(const JsonValue& root) {
  if (mediapipe::IsTypicalFrame(root)) return true;
  constexpr std::size_t kFramesToTry = 1000;
  const JsonValue list = root.Has("frames") ? root["frames"] : root;
  if (list.json().is_array()) {
    for (std::size_t i = 0; i < std::min(list.ArraySize(), kFramesToTry); ++i) {
      if (mediapipe::IsTypicalFrame(list.At(i))) return true;
    }
    return false;
  }
  if (!list.json().is_object()) return false;
  const std::vector<std::string> keys = list.Keys();
  return std::any_of(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(std::min(keys.size(), kFramesToTry)),
                     [&](const std::string& key) {
                       return key.find_first_not_of("0123456789") == std::string::npos &&
                              mediapipe::IsTypicalFrame(list[key]);
                     });
}

}  // namespace canonpose
