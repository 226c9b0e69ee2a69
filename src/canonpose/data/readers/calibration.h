// A camera calibration as JSON: {units, image_size?, cameras: {NAME: {K, R, t, distortion?, image_size?}}}.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "canonpose/geometry/camera.h"

namespace canonpose {

struct CalibratedCamera {
  Camera camera;
  std::optional<std::array<int, 2>> image_size;  ///< width, height in pixels
};

/// x_camera = R * x_world + t, in the file's units ("mm" or "m"), pixel = K * distort(x_camera / z). Throws
/// Error(kBadInput), also where K is no camera matrix or R no rotation.
std::map<std::string, CalibratedCamera> ReadCalibration(const std::filesystem::path& path);

/// The camera of that name. Throws Error(kBadInput) naming it and those that `path` has.
const CalibratedCamera& FindCalibration(const std::map<std::string, CalibratedCamera>& cameras, const std::string& name,
                                        const std::filesystem::path& path);

}  // namespace canonpose
