// The cameras of a scene as calibrations for other programs. docs/export.md shows each format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/export/file_space.h"

namespace canonpose {

enum class CalibrationFormat {
  kPose2Sim,    ///< Calib.toml: rotation vectors, metres
  kOpenCv,      ///< YAML for cv::FileStorage, with EasyMocap's keys
  kAniposelib,  ///< calibration.toml
  kColmap,      ///< a folder with cameras.txt, images.txt and points3D.txt
  kJson,        ///< ours: what ReadCalibration() reads
};

/// "pose2sim", "opencv", "anipose", "colmap" or "json"; nothing for other names.
std::optional<CalibrationFormat> FindCalibrationFormat(const std::string& name);

/// The format that the name of a file stands for: .toml, .yml or .yaml, or none at all for a folder (COLMAP); nothing
/// for other extensions.
std::optional<CalibrationFormat> CalibrationFormatOf(const std::filesystem::path& path);

/// Throws Error(kInvalidArgument) where the extension of `path` is not one of the format's.
void RequireCalibrationName(const std::filesystem::path& path, CalibrationFormat format);

/// Cameras that are unknown; they are left out of a calibration.
std::vector<std::string> CamerasWithoutCalibration(const Scene& scene);

/// Writes the calibrated cameras. `space` is that of a FileSpace; Pose2Sim's file takes one in metres. Throws
/// Error(kInvalidArgument) where no camera is calibrated, where a camera moves and the format has one place per camera
/// (moving cameras: COLMAP, with an image per frame, and JSON), or where a lens is not one of the format's; and
/// Error(kBadInput) where the file cannot be written.
void WriteCalibration(const std::filesystem::path& path, CalibrationFormat format, const Scene& scene,
                      const FileSpace& space);

}  // namespace canonpose
