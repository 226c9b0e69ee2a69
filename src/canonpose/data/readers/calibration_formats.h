// The readers behind ReadCalibration(), one per format, and what they check alike. Only for calibration*.cc.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/data/readers/calibration.h"

namespace canonpose {

using CalibratedCameras = std::map<std::string, CalibratedCamera>;

CalibratedCameras ReadJsonCalibration(const std::filesystem::path& path);
/// Pose2Sim's and aniposelib's.
CalibratedCameras ReadTomlCalibration(const std::filesystem::path& path);
/// OpenCV's FileStorage as YAML with EasyMocap's keys, in one file, or in intri.yml and extri.yml beside each other.
CalibratedCameras ReadOpenCvCalibration(const std::filesystem::path& path);
/// Qualisys Track Manager's .qca.txt.
CalibratedCameras ReadQualisysCalibration(const std::filesystem::path& path);

/// Where a value stands in a calibration file, for errors.
struct CalibrationPlace {
  std::string file;
  std::string place;  ///< "cam_01.matrix"
  [[nodiscard]] CalibrationPlace At(const std::string& member) const { return {file, place + "." + member}; }
  [[noreturn]] void Fail(const std::string& expected, const std::string& found, const std::string& advice = "") const;
};

/// The matrix of 9 numbers, row by row; fails unless it is [[fx, s, cx], [0, fy, cy], [0, 0, 1]] with fx, fy > 0.
Eigen::Matrix3d CheckedCameraMatrix(std::span<const double> numbers, const CalibrationPlace& place);

/// A rotation from 9 numbers row by row, or from 3, a rotation vector (Rodrigues); fails where it is none.
Eigen::Matrix3d CheckedRotation(std::span<const double> numbers, const CalibrationPlace& place);

/// OpenCV's k1, k2, p1, p2 and, where it is there, k3; fails for other numbers of coefficients than 0, 4 and 5, unless
/// the rest is 0.
std::array<double, 5> CheckedDistortion(std::span<const double> numbers, const CalibrationPlace& place);

Eigen::Vector3d CheckedTranslation(std::span<const double> numbers, double mm_per_unit, const CalibrationPlace& place);

std::array<int, 2> CheckedImageSize(std::span<const double> numbers, const CalibrationPlace& place);

/// Millimetres per unit of that name; fails for others than "mm" and "m".
double MillimetresPerUnit(const std::string& unit, const CalibrationPlace& place);

/// Adds a camera; fails where there is one of that name.
void AddCalibratedCamera(CalibratedCameras& calibration, const std::string& name, const CalibratedCamera& camera,
                         const CalibrationPlace& place);

}  // namespace canonpose
