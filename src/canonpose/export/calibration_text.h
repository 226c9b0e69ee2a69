// What the writers of calibrations share. Only for calibration*.cc.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// A number that reads back as the same double and looks like a float in every language: "1.0", "2.5e-07".
std::string FloatText(double number);

/// "1.0, 2.0"
std::string FloatList(const std::vector<double>& numbers);

/// k1, k2, p1, p2, and k3 where it is not 0 or `always_five`.
std::vector<double> Coefficients(const Camera& camera, bool always_five);

/// The rotation vector of a camera (Rodrigues): axis times angle in radians.
std::vector<double> RotationVector(const Camera& camera);

/// A text in double quotes, as TOML and YAML have it.
std::string QuotedText(const std::string& text);

std::string TomlCalibration(const Scene& scene, const FileSpace& space, bool is_pose2sim);
std::string OpenCvCalibration(const Scene& scene, const FileSpace& space);
std::string JsonCalibration(const Scene& scene, const FileSpace& space);
void WriteColmapFolder(const std::filesystem::path& path, const Scene& scene, const FileSpace& space);

}  // namespace canonpose
