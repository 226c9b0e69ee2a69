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

/// Reads the cameras of a file: x_camera = R * x_world + t, in the file's units ("mm" or "m"), pixel = K *
/// distort(x_camera / z). Throws Error(kBadInput), also where K is not a camera matrix or R is not a rotation.
std::map<std::string, CalibratedCamera> ReadCalibration(const std::filesystem::path& path);

/// The camera of that name. Throws Error(kBadInput) that names it and the cameras in `path`.
const CalibratedCamera& FindCalibration(const std::map<std::string, CalibratedCamera>& cameras, const std::string& name,
                                        const std::filesystem::path& path);

}  // namespace canonpose
