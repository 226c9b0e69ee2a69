// What the targets of the detectors' formats share.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "fuzzing.h"

#include "canonpose/data/own_layout.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose::fuzz {

inline void ReadDetections(std::string_view format_name, const std::filesystem::path& path) {
  DetectFormat(path);
  const DetectionFormat& format = FindDetectionFormat(format_name);
  for (CameraInput input : format.find_cameras(path)) {
    input.image_size = {640, 480};
    std::vector<KeypointClip> clips{FollowPerson(format.read(input), 1)};
    LayoutOf(clips, "");
  }
}

}  // namespace canonpose::fuzz
