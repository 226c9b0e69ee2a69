#include <set>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/readers/opencv_keys.h"
#include "canonpose/export/calibration_text.h"

namespace canonpose {
namespace {

std::string OpenCvMatrix(const std::string& key, int rows, int columns, const std::vector<double>& numbers) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", key, rows, columns,
                     FloatList(numbers));
}

/// Throws where two cameras would have the same keys.
void RequireDistinctKeys(const Scene& scene) {
  std::set<std::string> keys;
  for (const SceneCamera& camera : scene.cameras) {
    if (keys.insert(OpenCvKey(camera.name)).second) continue;
    ThrowInvalidArgument("the names of two cameras are both {} in OpenCV's files, which allow few characters",
                         OpenCvKey(camera.name));
  }
}

std::vector<double> RowByRow(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = matrix;
  return {rows.data(), rows.data() + 9};
}

}  // namespace

std::string OpenCvCalibration(const Scene& scene, const FileSpace& space) {
  RequireDistinctKeys(scene);
  std::string text = "%YAML:1.0\n---\nnames:\n";
  for (const SceneCamera& camera : scene.cameras) {
    if (!camera.calibration.empty()) text += fmt::format("   - {}\n", QuotedText(camera.name));
  }
  text += fmt::format("unit: {}\nup: {}\n", QuotedText(space.unit()), QuotedText(space.up()));
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.empty()) continue;
    const Camera in_file = space.InFile(camera.calibration.front());
    const Eigen::Vector3d& t = in_file.camera_from_world_translation;
    const std::string key = OpenCvKey(camera.name);
    text += OpenCvMatrix("K_" + key, 3, 3, RowByRow(in_file.K));
    text += OpenCvMatrix("dist_" + key, 1, 5, Coefficients(in_file, true));
    text += fmt::format("H_{0}: {2}\nW_{0}: {1}\n", key, camera.image_size_px[0], camera.image_size_px[1]);
    text += OpenCvMatrix("R_" + key, 3, 1, RotationVector(in_file));
    text += OpenCvMatrix("Rot_" + key, 3, 3, RowByRow(in_file.camera_from_world_rotation));
    text += OpenCvMatrix("T_" + key, 3, 1, {t.x(), t.y(), t.z()});
  }
  return text;
}

}  // namespace canonpose
