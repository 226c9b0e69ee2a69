// Finding videos, of a build without LibTorch, and so without a detector.
#include "canonpose/base/error.h"
#include "canonpose/pipeline/recording_inputs.h"

namespace canonpose {

RecordingInputs FindRecordedVideos(const std::vector<std::string>& paths) {
  ThrowInvalidArgument(
      "{}: videos need networks, and this canonpose was built without LibTorch; give a detector's keypoints, or build "
      "it "
      "with CANONPOSE_WITH_TORCH=ON",
      paths.front());
}

bool IsFolderOfVideos(const std::filesystem::path&) { return false; }

}  // namespace canonpose
