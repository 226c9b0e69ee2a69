#include "canonpose/data/readers/calibration.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/calibration_formats.h"

namespace canonpose {
namespace {

/// A rotation that was written with few digits is only orthonormal to about this.
constexpr double kRotationTolerance = 1e-3;
/// Pixels of the longer side of an image.
constexpr double kLargestImage = 1e6;

bool AreFinite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

Eigen::Matrix3d MatrixOfRows(std::span<const double> numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

/// A name without case and punctuation.
std::string LettersAndDigits(const std::string& name) {
  std::string letters = LowerCase(name);
  std::erase_if(letters, [](unsigned char c) { return c < 0x80 && std::isalnum(c) == 0; });
  return letters;
}

}  // namespace

void CalibrationPlace::Fail(const std::string& expected, const std::string& found, const std::string& advice) const {
  ThrowBadInput({file, place, expected, found, advice});
}

Eigen::Matrix3d CheckedCameraMatrix(std::span<const double> numbers, const CalibrationPlace& place) {
  constexpr const char* kExpected = "[[fx, s, cx], [0, fy, cy], [0, 0, 1]] with fx, fy > 0";
  if (numbers.size() != 9) place.Fail(kExpected, fmt::format("{} values", numbers.size()));
  const Eigen::Matrix3d K = MatrixOfRows(numbers);
  const bool is_camera_matrix = K.allFinite() && K(0, 0) > 0 && K(1, 1) > 0 && K(2, 2) == 1.0 && K(1, 0) == 0.0 &&
                                K(2, 0) == 0.0 && K(2, 1) == 0.0;
  if (!is_camera_matrix) place.Fail(kExpected, "another matrix");
  return K;
}

Eigen::Matrix3d CheckedRotation(std::span<const double> numbers, const CalibrationPlace& place) {
  if (numbers.size() != 3 && numbers.size() != 9) {
    place.Fail("a rotation of 3 or 9 values", fmt::format("{} values", numbers.size()));
  }
  if (!AreFinite(numbers)) place.Fail("a rotation", "values that are not finite");
  if (numbers.size() == 3) {
    const Eigen::Vector3d vector(numbers[0], numbers[1], numbers[2]);
    const double angle = vector.norm();
    if (!std::isfinite(angle)) place.Fail("a rotation vector in radians", "values that are far too large");
    return angle == 0.0 ? Eigen::Matrix3d::Identity() : Eigen::AngleAxisd(angle, vector / angle).matrix();
  }
  const Eigen::Matrix3d rotation = MatrixOfRows(numbers);
  const double error = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance) || rotation.determinant() < 0) {
    place.Fail("a rotation matrix",
               fmt::format("determinant {:.3g}, R*R^T off by {:.2g}", rotation.determinant(), error));
  }
  return rotation;
}

std::array<double, 5> CheckedDistortion(std::span<const double> numbers, const CalibrationPlace& place) {
  std::array<double, 5> distortion{};
  if (!AreFinite(numbers)) place.Fail("4 or 5 values (k1, k2, p1, p2, k3)", "values that are not finite");
  const bool is_simple =
      std::all_of(numbers.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, numbers.size())),
                  numbers.end(), [](double k) { return k == 0.0; });
  if ((!numbers.empty() && numbers.size() < 4) || !is_simple) {
    place.Fail("4 or 5 values (k1, k2, p1, p2, k3)", fmt::format("{} values", numbers.size()),
               "calibrate with OpenCV's standard model of the lens");
  }
  std::copy_n(numbers.begin(), std::min<std::size_t>(5, numbers.size()), distortion.begin());
  return distortion;
}

Eigen::Vector3d CheckedTranslation(std::span<const double> numbers, double mm_per_unit, const CalibrationPlace& place) {
  if (numbers.size() != 3 || !AreFinite(numbers)) {
    place.Fail("3 finite values", numbers.size() == 3 ? "others" : fmt::format("{} values", numbers.size()));
  }
  return mm_per_unit * Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

std::array<int, 2> CheckedImageSize(std::span<const double> numbers, const CalibrationPlace& place) {
  if (numbers.size() != 2) place.Fail("width and height", fmt::format("{} values", numbers.size()));
  for (const double pixels : numbers) {
    if (!(pixels >= 1.0 && pixels <= kLargestImage) || pixels != std::floor(pixels)) {
      place.Fail("a number of pixels", fmt::format("{}", pixels));
    }
  }
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

double MillimetresPerUnit(const std::string& unit, const CalibrationPlace& place) {
  if (unit == "mm") return 1.0;
  if (unit == "m") return 1000.0;
  place.Fail("\"mm\" or \"m\"", '"' + unit + '"',
             unit == "body lengths" ? "the size of that recording is unknown, so its cameras calibrate nothing in "
                                      "millimetres; solve it with `height` and export them again"
                                    : "");
}

void AddCalibratedCamera(CalibratedCameras& calibration, const std::string& name, const CalibratedCamera& camera,
                         const CalibrationPlace& place) {
  if (!calibration.emplace(name, camera).second) {
    place.Fail("another name for each camera", "a second camera " + name);
  }
}

std::map<std::string, CalibratedCamera> ReadCalibration(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  const char first = FirstCharacter(path);
  if (first == '<' || LowerCase(path.filename().string()).ends_with(".qca.txt")) return ReadQualisysCalibration(path);
  if (first == '%' || extension == ".yml" || extension == ".yaml") return ReadOpenCvCalibration(path);
  if (extension == ".toml") return ReadTomlCalibration(path);
  return ReadJsonCalibration(path);
}

const CalibratedCamera& FindCalibration(const std::map<std::string, CalibratedCamera>& cameras, const std::string& name,
                                        const std::filesystem::path& path) {
  const auto found = cameras.find(name);
  if (found != cameras.end()) return found->second;
  const CalibratedCamera* similar = nullptr;
  int similar_count = 0;
  std::string names;
  for (const auto& [other, camera] : cameras) {
    names += (names.empty() ? "" : ", ") + other;
    if (LettersAndDigits(other) != LettersAndDigits(name)) continue;
    similar = &camera;
    ++similar_count;
  }
  if (similar_count == 1) return *similar;
  ThrowBadInput({path.string(), "cameras", "camera " + name, names,
                 "use the same names for the cameras; see `camera` NAME=PATH"});
}

}  // namespace canonpose
