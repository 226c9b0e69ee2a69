#include "canonpose/export/calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/export/calibration_text.h"

namespace canonpose {
namespace {

struct CalibrationFormatFacts {
  CalibrationFormat format;
  const char* name;
  const char* program;
  std::vector<std::string> extensions;
  bool holds_moving_cameras;
};

const std::vector<CalibrationFormatFacts>& CalibrationFormats() {
  using enum CalibrationFormat;
  static const std::vector<CalibrationFormatFacts> formats = {
      {kPose2Sim, "pose2sim", "Pose2Sim", {".toml"}, false},
      {kOpenCv, "opencv", "OpenCV", {".yml", ".yaml"}, false},
      {kAniposelib, "anipose", "aniposelib", {".toml"}, false},
      {kColmap, "colmap", "COLMAP", {""}, true},
      {kJson, "json", "canonpose", {".json"}, true},
  };
  return formats;
}

const CalibrationFormatFacts& FactsOf(CalibrationFormat format) {
  return *std::ranges::find(CalibrationFormats(), format, &CalibrationFormatFacts::format);
}

void RequireCalibratedCameras(const Scene& scene, const CalibrationFormatFacts& format) {
  bool any = false;
  for (const SceneCamera& camera : scene.cameras) {
    any |= !camera.calibration.empty();
    if (camera.calibration.size() <= 1 || format.holds_moving_cameras) continue;
    ThrowInvalidArgument(
        "camera {} moves, and a calibration of {} has one place for each camera; write COLMAP's files or JSON",
        camera.name, format.program);
  }
  if (!any) ThrowInvalidArgument("{}: there are no calibrated cameras to write; solve a recording first", scene.name);
}

}  // namespace

std::optional<CalibrationFormat> FindCalibrationFormat(const std::string& name) {
  for (const CalibrationFormatFacts& format : CalibrationFormats()) {
    if (SameName(format.name, name)) return format.format;
  }
  return std::nullopt;
}

std::optional<CalibrationFormat> CalibrationFormatOf(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  for (const CalibrationFormatFacts& format : CalibrationFormats()) {
    if (format.format == CalibrationFormat::kJson) continue;  // a scene, unless the calibration is asked for
    if (std::ranges::count(format.extensions, extension) > 0) return format.format;
  }
  return std::nullopt;
}

void RequireCalibrationName(const std::filesystem::path& path, CalibrationFormat format) {
  const CalibrationFormatFacts& facts = FactsOf(format);
  if (std::ranges::count(facts.extensions, LowerCase(path.extension().string())) > 0) return;
  const std::string& expected = facts.extensions.front();
  ThrowInvalidArgument("{}: a calibration of {} is {}", path.string(), facts.program,
                       expected.empty() ? "a folder, whose name has no extension" : "a file that ends in " + expected);
}

std::vector<std::string> CamerasWithoutCalibration(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.empty()) names.push_back(camera.name);
  }
  return names;
}

void WriteCalibration(const std::filesystem::path& path, CalibrationFormat format, const Scene& scene,
                      const FileSpace& space) {
  RequireCalibratedCameras(scene, FactsOf(format));
  CANONPOSE_CHECK(format != CalibrationFormat::kPose2Sim || space.unit() != "mm", "Pose2Sim's files are in metres");
  switch (format) {
    case CalibrationFormat::kPose2Sim:
    case CalibrationFormat::kAniposelib:
      return WriteFileAtomically(path, TomlCalibration(scene, space, format == CalibrationFormat::kPose2Sim));
    case CalibrationFormat::kOpenCv:
      return WriteFileAtomically(path, OpenCvCalibration(scene, space));
    case CalibrationFormat::kJson:
      return WriteFileAtomically(path, JsonCalibration(scene, space));
    case CalibrationFormat::kColmap:
      return WriteColmapFolder(path, scene, space);
  }
}

std::string FloatText(double number) {
  std::string text = fmt::format("{}", number);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // n: nan, inf
  return text;
}

std::string FloatList(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + FloatText(number);
  return text;
}

std::vector<double> Coefficients(const Camera& camera, bool always_five) {
  const std::size_t count = always_five || camera.distortion[4] != 0.0 ? 5 : 4;
  return {camera.distortion.begin(), camera.distortion.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<double> RotationVector(const Camera& camera) {
  // By way of the quaternion, which is stable near half a turn.
  const Eigen::AngleAxisd rotation(Eigen::Quaterniond(camera.camera_from_world_rotation).normalized());
  const Eigen::Vector3d vector = rotation.angle() * rotation.axis();
  return {vector.x(), vector.y(), vector.z()};
}

std::string QuotedText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      quoted += ' ';
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace canonpose
