#include "canonpose/data/readers/calibration.h"

#include <algorithm>

#include <Eigen/LU>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"

namespace canonpose {
namespace {

/// A rotation that was written with few digits is only orthonormal to about this.
constexpr double kRotationTolerance = 1e-3;

Eigen::Matrix3d Matrix3(const JsonValue& value) {
  if (value.ArraySize() != 3) value.Fail("3 rows of 3 values");
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) {
    const JsonValue line = value.At(static_cast<std::size_t>(row));
    const std::vector<double> numbers = line.Numbers();
    if (numbers.size() != 3) line.Fail("3 values");
    for (int column = 0; column < 3; ++column) matrix(row, column) = numbers[static_cast<std::size_t>(column)];
  }
  return matrix;
}

std::array<int, 2> ImageSize(const JsonValue& value) {
  if (value.ArraySize() != 2) value.Fail("width and height");
  std::array<int, 2> size{};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::int64_t pixels = value.At(i).Integer();
    if (pixels < 1 || pixels > 1'000'000) value.At(i).Fail("a number of pixels");
    size[i] = static_cast<int>(pixels);
  }
  return size;
}

CalibratedCamera ReadCamera(const JsonValue& value, double mm_per_unit) {
  CalibratedCamera calibrated;
  Camera& camera = calibrated.camera;
  camera.K = Matrix3(value["K"]);
  const bool is_camera_matrix = camera.K(0, 0) > 0 && camera.K(1, 1) > 0 && camera.K(2, 2) == 1.0 &&
                                camera.K(1, 0) == 0.0 && camera.K(2, 0) == 0.0 && camera.K(2, 1) == 0.0;
  if (!is_camera_matrix) value["K"].Fail("[[fx, s, cx], [0, fy, cy], [0, 0, 1]] with fx, fy > 0", "", "another matrix");
  camera.camera_from_world_rotation = Matrix3(value["R"]);
  const Eigen::Matrix3d& rotation = camera.camera_from_world_rotation;
  const double error = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance || rotation.determinant() < 0) {
    value["R"].Fail("a rotation matrix", "",
                    fmt::format("determinant {:.3g}, R*R^T off by {:.2g}", rotation.determinant(), error));
  }
  const std::vector<double> translation = value["t"].Numbers();
  if (translation.size() != 3) value["t"].Fail("3 values");
  camera.camera_from_world_translation = mm_per_unit * Eigen::Vector3d(translation[0], translation[1], translation[2]);
  if (const std::optional<JsonValue> distortion = value.Find("distortion")) {
    const std::vector<double> numbers = distortion->Numbers();
    if (numbers.size() != 4 && numbers.size() != 5) distortion->Fail("4 or 5 values (k1, k2, p1, p2, k3)");
    std::copy(numbers.begin(), numbers.end(), camera.distortion.begin());
  }
  if (const std::optional<JsonValue> size = value.Find("image_size")) calibrated.image_size = ImageSize(*size);
  return calibrated;
}

}  // namespace

std::map<std::string, CalibratedCamera> ReadCalibration(const std::filesystem::path& path) {
  const JsonValue root = JsonValue::Load(path);
  const JsonValue cameras = root["cameras"];
  double mm_per_unit = 1.0;
  if (const std::optional<JsonValue> units = root.Find("units")) {
    const std::string name = units->String();
    if (name != "mm" && name != "m") units->Fail("\"mm\" or \"m\"");
    mm_per_unit = name == "m" ? 1000.0 : 1.0;
  }
  std::map<std::string, CalibratedCamera> calibrated;
  for (const std::string& name : cameras.Keys()) {
    CalibratedCamera camera = ReadCamera(cameras[name], mm_per_unit);
    const std::optional<JsonValue> common_size = root.Find("image_size");
    if (!camera.image_size && common_size) camera.image_size = ImageSize(*common_size);
    calibrated.emplace(name, camera);
  }
  if (calibrated.empty()) cameras.Fail("at least one camera", "", "none");
  return calibrated;
}

const CalibratedCamera& FindCalibration(const std::map<std::string, CalibratedCamera>& cameras, const std::string& name,
                                        const std::filesystem::path& path) {
  const auto found = cameras.find(name);
  if (found != cameras.end()) return found->second;
  std::string names;
  for (const auto& [other, camera] : cameras) names += (names.empty() ? "" : ", ") + other;
  ThrowBadInput({path.string(), "cameras", "camera " + name, names,
                 "use the same names for the cameras; see `camera` NAME=PATH"});
}

}  // namespace canonpose
