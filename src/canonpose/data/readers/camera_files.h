// Formats with one file per camera that is not JSON, and coordinates that are fractions of the image.
//
// For readers only.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// How to find the cameras of a format.
struct CameraFiles {
  std::vector<std::string_view> extensions;  ///< in lower case: ".csv"
  std::string_view expected;                 ///< "a csv or h5 file of DeepLabCut for each camera"
  bool (*is_ours)(const std::filesystem::path& file);
  std::string (*camera_name)(const std::filesystem::path& file);
};

/// The cameras of a path. A file is a camera, whatever is in it. In a folder, each file of the format is a camera; or
/// each sub-folder with one such file, if the folder itself has none. Other files are left out, with a warning that
/// counts those with one of the extensions. Where the same camera has a file with each of two extensions, the one whose
/// extension comes first is taken. Throws Error(kBadInput) where there is no camera.
std::vector<CameraInput> FindCameraFiles(const std::filesystem::path& path, const CameraFiles& files);

/// The largest coordinate of all people, in either direction from 0.
float LargestCoordinate(const DetectedCamera& camera);
/// Above this, coordinates are pixels.
inline constexpr float kLargestImageFraction = 3.0F;

/// Multiplies coordinates that are fractions of the image by its size. Throws Error(kBadInput) where that is unknown.
void FractionsToPixels(DetectedCamera& camera, std::array<int, 2> image_size);

}  // namespace canonpose
