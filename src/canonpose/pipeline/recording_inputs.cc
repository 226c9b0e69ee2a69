#include "canonpose/pipeline/recording_inputs.h"

#include <set>
#include <system_error>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

void RequireNoDataset(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || !IsDatasetFile(path)) return;
  ThrowBadInput({path, "", "videos, or the keypoints of each camera", "a dataset, whose keypoints are imported already",
                 "use `canonpose solve`, `canonpose view` and `canonpose train`"});
}

/// The format of a path with keypoints; empty for anything else. The content alone does not tell: videos are too large
/// to be tried as JSON.
std::string FormatOf(const std::string& path) {
  static const std::set<std::string> extensions{".json", ".csv", ".h5", ".hdf5", ".npy", ".txt"};
  std::error_code error;
  const bool may_hold_keypoints = fs::is_directory(path, error)
                                      ? !IsFolderOfVideos(path)
                                      : extensions.contains(LowerCase(fs::path(path).extension().string()));
  return may_hold_keypoints ? LooksLikeFormat(path) : "";
}

RecordingInputs FindKeypoints(const std::vector<std::string>& paths, const std::string& format) {
  RecordingInputs inputs;
  inputs.format = format;
  const DetectionFormat& reader = FindDetectionFormat(format);
  for (const std::string& path : paths) {
    for (const CameraInput& camera : reader.find_cameras(path)) inputs.cameras.push_back({camera.name, {camera.path}});
  }
  return inputs;
}

void RequireTwoCameras(const RecordingInputs& inputs, const std::string& path) {
  if (inputs.cameras.size() >= 2) return;
  const char* const what = inputs.are_videos ? "video" : "camera's keypoints";
  ThrowBadInput({path, "", fmt::format("at least two cameras that filmed at the same time"),
                 fmt::format("one {}", what),
                 "give them all; 3D poses from one camera are what `canonpose lift` makes with a model"});
}

}  // namespace

RecordingInputs FindRecording(const std::vector<std::string>& paths, const std::string& format) {
  if (paths.empty()) ThrowInvalidArgument("give the videos of a recording, or a folder that holds them");
  std::string known = format;
  std::string video;      // the first path that holds no keypoints
  std::string keypoints;  // the first that does
  for (const std::string& path : paths) {
    RequireNoDataset(path);
    const std::string own = format.empty() ? FormatOf(path) : format;
    (own.empty() ? video : keypoints) = path;
    if (known.empty()) known = own;
    if (own.empty() || own == known) continue;
    ThrowBadInput({path, "", fmt::format("keypoints of {} like the others", known), "those of " + own,
                   "make all keypoints with one detector, or name `format`"});
  }
  if (!video.empty() && !keypoints.empty()) {
    ThrowBadInput({video, "", fmt::format("keypoints like {}", keypoints), "none", "give either videos or keypoints"});
  }
  RecordingInputs inputs = video.empty() ? FindKeypoints(paths, known) : FindRecordedVideos(paths);
  RequireTwoCameras(inputs, paths.front());
  return inputs;
}

}  // namespace canonpose
