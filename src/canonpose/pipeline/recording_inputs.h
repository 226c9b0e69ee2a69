// What a recording is given as: videos, or the keypoints that a detector found in them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace canonpose {

/// One camera of a recording.
struct RecordedCamera {
  std::string name;
  std::vector<std::filesystem::path> files;  ///< the video, or its images; for keypoints, their file or folder
};

struct RecordingInputs {
  bool are_videos = false;
  bool are_images = false;  ///< videos of which at least one is a folder of images
  std::string format;       ///< of keypoints, the name of one of DetectionFormats(); otherwise empty
  std::vector<RecordedCamera> cameras;
};

/// The cameras that `paths` stand for. `format` is that of keypoints where it is known; empty: a path whose content is
/// that of a detector's files holds keypoints, unless there are videos beside them; anything else is a video. Throws
/// Error(kBadInput) where a path is neither, the paths are of both kinds, or there are fewer than two cameras, and
/// Error(kInvalidArgument) for an unknown format.
RecordingInputs FindRecording(const std::vector<std::string>& paths, const std::string& format);

/// The videos that `paths` stand for; a build without LibTorch has no detector and throws Error(kInvalidArgument).
RecordingInputs FindRecordedVideos(const std::vector<std::string>& paths);

/// Whether a folder holds videos; false in a build without a detector.
bool IsFolderOfVideos(const std::filesystem::path& folder);

}  // namespace canonpose
