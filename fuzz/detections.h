// What the targets of the detectors' formats share.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "fuzzing.h"

#include "canonpose/data/layout_check.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose::fuzz {

inline void ReadDetections(std::string_view format_name, const std::filesystem::path& path) {
  DetectFormat(path);
  const DetectionFormat& format = FindDetectionFormat(format_name);
  for (const CameraInput& input : format.find_cameras(path)) {
    const KeypointClip clip = FollowPerson(format.read(input), 1);
    CheckLayout(std::span(&clip, 1), "");
  }
}

}  // namespace canonpose::fuzz
