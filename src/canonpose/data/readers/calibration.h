// Calibrated cameras by name, in the files of several programs: ours (JSON), Pose2Sim's and aniposelib's (TOML),
// OpenCV's FileStorage (YAML, with EasyMocap's keys) and Qualisys Track Manager's (XML, .qca.txt). docs/formats.md
// shows each.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/geometry/camera.h"

namespace canonpose {

struct CalibratedCamera {
  Camera camera;
  std::optional<std::array<int, 2>> image_size;  ///< width, height in pixels
  std::vector<Camera> per_frame{};               ///< of a camera that moves; empty for one that stands still
};

/// Reads the cameras of a file of any of these formats, recognised by its content: x_camera = R * x_world + t with t in
/// millimetres, pixel = K * distort(x_camera / z). A translation whose unit the file does not say is returned as it is
/// written. Throws Error(kBadInput), also where K is not a camera matrix or R is not a rotation, where a lens has
/// another model (fisheye), and where the file says that its lengths have no known unit.
std::map<std::string, CalibratedCamera> ReadCalibration(const std::filesystem::path& path);

/// The camera of that name, or else the only one whose name differs from it in nothing but case and punctuation, such
/// as "cam_01" for "cam01". Throws Error(kBadInput) that names it and the cameras in `path`.
const CalibratedCamera& FindCalibration(const std::map<std::string, CalibratedCamera>& cameras, const std::string& name,
                                        const std::filesystem::path& path);

}  // namespace canonpose
