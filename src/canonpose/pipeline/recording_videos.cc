// Finding videos, of a build with a detector.
#include "canonpose/pipeline/recording_inputs.h"
#include "canonpose/video/video_reader.h"

namespace canonpose {

RecordingInputs FindRecordedVideos(const std::vector<std::string>& paths) {
  RecordingInputs inputs;
  inputs.are_videos = true;
  for (const VideoSource& source : FindVideos(paths)) {
    inputs.are_images = inputs.are_images || !source.images.empty();
    inputs.cameras.push_back(
        {source.name, source.images.empty() ? std::vector<std::filesystem::path>{source.path} : source.images});
  }
  return inputs;
}

bool IsFolderOfVideos(const std::filesystem::path& folder) { return HoldsVideos(folder); }

}  // namespace canonpose
