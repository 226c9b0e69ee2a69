// What `detect` says of the video whose keypoints are in a folder: the file video.json beside the frames.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace canonpose {

inline constexpr std::string_view kVideoFactsFile = "video.json";
/// What its member `format` says.
inline constexpr std::string_view kVideoFactsFormat = "canonpose-video";

struct VideoFacts {
  std::array<int, 2> image_size{0, 0};  ///< width, height in pixels
  double fps = 0.0;                     ///< 0 where unknown
  std::vector<double> times_seconds;    ///< (T), rising; empty where unknown
  long frames_skipped = 0;
};

/// The facts of a camera's folder; nothing where the path is no folder or has no such file. Throws Error(kBadInput)
/// where the file is damaged.
std::optional<VideoFacts> ReadVideoFacts(const std::filesystem::path& folder);

}  // namespace canonpose
