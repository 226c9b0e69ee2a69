#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/readers/calibration_formats.h"

namespace canonpose {
namespace {

toml::table ParseToml(const std::filesystem::path& path) {
  const std::string text = ReadFile(path);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    ThrowBadInput({path.string(), fmt::format("line {}", error.source().begin.line), "TOML",
                   std::string(error.description()), "restore the file or calibrate again"});
  }
}

/// Appends the numbers of an array of numbers, or of arrays of them.
void AppendTomlNumbers(const toml::node& node, const CalibrationPlace& place, int depth, std::vector<double>& numbers) {
  if (const std::optional<double> number = node.value<double>()) {
    numbers.push_back(*number);
  } else if (const toml::array* array = node.as_array(); array != nullptr && depth > 0) {
    for (const toml::node& element : *array) AppendTomlNumbers(element, place, depth - 1, numbers);
  } else {
    place.Fail("an array of numbers", "something else");
  }
}

std::vector<double> TomlNumbers(const toml::table& table, const std::string& key, const CalibrationPlace& place) {
  const toml::node* node = table.get(key);
  if (node == nullptr) place.Fail(key, "nothing", "calibrate the camera, or give another calibration");
  std::vector<double> numbers;
  AppendTomlNumbers(*node, place.At(key), 2, numbers);
  return numbers;
}

CalibratedCamera ReadTomlCamera(const toml::table& table, double mm_per_unit, const CalibrationPlace& place) {
  if (table["fisheye"].value_or(false)) {
    place.At("fisheye").Fail("false", "true", "cameras with a fisheye lens cannot be read: undistort the videos first");
  }
  CalibratedCamera calibrated;
  Camera& camera = calibrated.camera;
  camera.K = CheckedCameraMatrix(TomlNumbers(table, "matrix", place), place.At("matrix"));
  camera.distortion = CheckedDistortion(TomlNumbers(table, "distortions", place), place.At("distortions"));
  camera.camera_from_world_rotation = CheckedRotation(TomlNumbers(table, "rotation", place), place.At("rotation"));
  camera.camera_from_world_translation =
      CheckedTranslation(TomlNumbers(table, "translation", place), mm_per_unit, place.At("translation"));
  if (table.contains("size"))
    calibrated.image_size = CheckedImageSize(TomlNumbers(table, "size", place), place.At("size"));
  return calibrated;
}

bool IsTomlCamera(const toml::table& table) { return table.contains("matrix") && table.contains("rotation"); }

/// Files of ours say the unit. Pose2Sim's are in metres, and say of every lens whether it is a fisheye; aniposelib's
/// have the unit of the calibration board, and say so of fisheyes only.
double TomlUnit(const toml::table& root, const std::string& file) {
  if (const auto unit = root["metadata"]["unit"]; unit.is_string()) {
    return MillimetresPerUnit(unit.value_or(std::string()), {file, "metadata.unit"});
  }
  for (const auto& [key, node] : root) {
    const toml::table* table = node.as_table();
    if (table != nullptr && IsTomlCamera(*table) && !table->contains("fisheye")) return 1.0;
  }
  return 1000.0;
}

}  // namespace

CalibratedCameras ReadTomlCalibration(const std::filesystem::path& path) {
  const toml::table root = ParseToml(path);
  const std::string file = path.string();
  const double mm_per_unit = TomlUnit(root, file);
  CalibratedCameras calibration;
  for (const auto& [key, node] : root) {
    const toml::table* table = node.as_table();
    if (table == nullptr || !IsTomlCamera(*table)) continue;  // metadata, the board, the volume of the capture
    const CalibrationPlace place{file, std::string(key.str())};
    const std::string name = (*table)["name"].value_or(std::string(key.str()));
    AddCalibratedCamera(calibration, name, ReadTomlCamera(*table, mm_per_unit, place), place);
  }
  if (calibration.empty()) {
    ThrowBadInput({file, "", "a table for each camera with size, matrix, distortions, rotation and translation", "none",
                   "give Pose2Sim's Calib.toml or aniposelib's calibration.toml"});
  }
  return calibration;
}

}  // namespace canonpose
