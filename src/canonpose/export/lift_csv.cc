#include <cmath>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/export/csv_cell.h"
#include "canonpose/export/lift_output.h"

namespace canonpose {
void WriteLiftCsv(const std::filesystem::path& path, const LiftedPoses& poses) {
  const double fps = poses.pose_in_camera.fps;
  const bool has_time = fps > 0.0;
  const std::string units = UnitsInFile(poses);
  std::string text = has_time ? "frame,time [s]" : "frame";
  for (const std::string& joint : poses.skeleton().joints) {
    for (const char axis : {'x', 'y', 'z'}) text += ',' + CsvCell(fmt::format("{}_{} [{}]", joint, axis, units));
  }
  for (const std::string& joint : poses.skeleton().joints) text += ',' + CsvCell(joint + "_confidence");
  for (const std::string& joint : poses.skeleton().joints)
    text += ',' + CsvCell(fmt::format("{}_sd [{}]", joint, units));
  text += '\n';
  const std::size_t joints = poses.skeleton().joints.size();
  const auto out = std::back_inserter(text);
  const auto append_row = [&](const std::vector<float>& values, std::size_t frame, std::size_t row) {
    for (std::size_t i = frame * row; i < (frame + 1) * row; ++i) {
      text += ',';
      if (std::isfinite(values[i])) fmt::format_to(out, "{}", values[i]);
    }
  };
  for (std::size_t t = 0; t < poses.frames.size(); ++t) {
    fmt::format_to(out, "{}", poses.frames[t]);
    if (has_time) fmt::format_to(out, ",{:.6f}", static_cast<double>(poses.frames[t]) / fps);
    append_row(poses.pose_in_camera.positions(), t, 3 * joints);
    append_row(poses.pose_in_camera.confidence(), t, joints);
    append_row(poses.pose_in_camera.standard_deviation(), t, joints);
    text += '\n';
  }
  WriteFileAtomically(path, text);
}

}  // namespace canonpose
