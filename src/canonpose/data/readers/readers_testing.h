// Shared by the tests of detectors' readers: reading one camera, and files with given text.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose::testing {

struct ReadOptions {
  std::array<int, 2> image_size{100, 200};
  int keypoint_count = 0;
};

/// All cameras of a path.
inline std::vector<DetectedCamera> ReadCameras(const std::string& format, const std::filesystem::path& path,
                                               const ReadOptions& options = {}) {
  const DetectionFormat& table = FindDetectionFormat(format);
  std::vector<DetectedCamera> cameras;
  for (CameraInput input : table.find_cameras(path)) {
    input.image_size = options.image_size;
    input.keypoint_count = options.keypoint_count;
    cameras.push_back(table.read(input));
  }
  return cameras;
}

/// The camera of a file with this name and text.
inline DetectedCamera ReadText(const std::string& format, const std::string& name, const std::string& text,
                               const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / name, text);
  return ReadCameras(format, folder / name, options).front();
}

/// What is wrong with it.
inline std::string ReadTextError(const std::string& format, const std::string& name, const std::string& text,
                                 const ReadOptions& options = {}) {
  return ErrorOf(ErrorKind::kBadInput, [&] { ReadText(format, name, text, options); });
}

/// x, y of a keypoint.
inline std::array<float, 2> PointOf(const DetectedPerson& person, std::size_t keypoint) {
  return {person.keypoints[2 * keypoint], person.keypoints[2 * keypoint + 1]};
}

}  // namespace canonpose::testing
