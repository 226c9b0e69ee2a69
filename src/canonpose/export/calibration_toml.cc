#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "canonpose/export/calibration_text.h"

namespace canonpose {
namespace {

/// A key of a table: bare where it may be.
std::string TomlKey(const std::string& name) {
  const bool is_bare = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-');
  });
  // These tables mean something else to the programs that read the file.
  const bool is_taken = name == "metadata" || name == "capture_volume" || name == "charuco" || name == "checkerboard";
  if (is_taken) return "camera_" + name;
  return is_bare ? name : QuotedText(name);
}

std::string MatrixRows(const Eigen::Matrix3d& matrix) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += (row == 0 ? "[ " : ", [ ") + FloatList({matrix(row, 0), matrix(row, 1), matrix(row, 2)}) + "]";
  }
  return text;
}

}  // namespace

std::string TomlCalibration(const Scene& scene, const FileSpace& space, bool is_pose2sim) {
  std::string text;
  // aniposelib takes the cameras in the order of the keys as text.
  const int digits = static_cast<int>(std::max<std::size_t>(2, fmt::format("{}", scene.cameras.size() - 1).size()));
  int number = 0;
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.empty()) continue;
    const Camera in_file = space.InFile(camera.calibration.front());
    const Eigen::Vector3d& t = in_file.camera_from_world_translation;
    text += fmt::format("[{}]\n", is_pose2sim ? TomlKey(camera.name) : fmt::format("cam_{:0{}}", number++, digits));
    text += fmt::format("name = {}\n", QuotedText(camera.name));
    text += fmt::format("size = [ {}{}, {}{}]\n", camera.image_size_px[0], is_pose2sim ? ".0" : "",
                        camera.image_size_px[1], is_pose2sim ? ".0" : "");
    text += fmt::format("matrix = [ {}]\n", MatrixRows(in_file.K));
    text += fmt::format("distortions = [ {}]\n", FloatList(Coefficients(in_file, !is_pose2sim)));
    text += fmt::format("rotation = [ {}]\n", FloatList(RotationVector(in_file)));
    text += fmt::format("translation = [ {}]\n", FloatList({t.x(), t.y(), t.z()}));
    if (is_pose2sim) text += "fisheye = false\n";
    text += '\n';
  }
  text += "[metadata]\nadjusted = false\nerror = 0.0\n";
  text += fmt::format("unit = {}\nup = {}\n", QuotedText(space.unit()), QuotedText(space.up()));
  return text;
}

}  // namespace canonpose
