#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/export/lift_output.h"

namespace canonpose {
namespace {

/// (T, rows, 3) as nested arrays, one frame per line. Not written by the library, which would print floats as doubles.
void AppendArray(std::string& text, const std::string& key, const std::vector<float>& values, std::size_t frames,
                 std::size_t rows) {
  text += fmt::format("  \"{}\": [", key);
  const auto out = std::back_inserter(text);
  std::size_t i = 0;
  for (std::size_t t = 0; t < frames; ++t) {
    text += t == 0 ? "\n    [" : ",\n    [";
    for (std::size_t r = 0; r < rows; ++r) {
      text += r == 0 ? "[" : ", [";
      for (int axis = 0; axis < 3; ++axis, ++i) {
        if (axis > 0) text += ", ";
        if (std::isfinite(values[i])) {
          fmt::format_to(out, "{}", values[i]);
        } else {
          text += "null";
        }
      }
      text += ']';
    }
    text += ']';
  }
  text += "\n  ]";
}

/// (T, J) likewise.
void AppendTable(std::string& text, const std::string& key, const std::vector<float>& values, std::size_t frames,
                 std::size_t columns) {
  text += fmt::format("  \"{}\": [", key);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < frames * columns; ++i) {
    if (i % columns == 0) text += i == 0 ? "\n    [" : "],\n    [";
    if (i % columns != 0) text += ", ";
    if (std::isfinite(values[i])) {
      fmt::format_to(out, "{}", values[i]);
    } else {
      text += "null";
    }
  }
  text += frames > 0 ? "]\n  ]" : "\n  ]";
}

}  // namespace

void WriteLiftJson(const std::filesystem::path& path, const LiftedPoses& poses) {
  const auto dump = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  const std::size_t frames = poses.frames.size();
  const std::size_t joints = poses.skeleton().joints.size();
  std::string text = "{\n";
  text += fmt::format("  \"units\": {},\n", dump(UnitsInFile(poses)));
  const double fps = poses.pose_in_camera.fps;
  if (fps > 0.0) text += fmt::format("  \"fps\": {},\n", dump(fps));
  text += fmt::format("  \"joints\": {},\n", dump(poses.skeleton().joints));
  text += fmt::format("  \"parents\": {},\n", dump(poses.skeleton().parents));
  text += fmt::format("  \"frames\": {},\n", dump(poses.frames));
  nlohmann::json seconds = nlohmann::json::array();
  for (const std::int64_t frame : poses.frames) {
    seconds.push_back(fps > 0.0 ? nlohmann::json(static_cast<double>(frame) / fps) : nlohmann::json());
  }
  text += fmt::format("  \"time\": {},\n", dump(seconds));
  AppendArray(text, "pose3d", poses.pose_in_camera.positions(), frames, joints);
  text += ",\n";
  AppendTable(text, "confidence", poses.pose_in_camera.confidence(), frames, joints);
  text += ",\n";
  AppendTable(text, "standard_deviation", poses.pose_in_camera.standard_deviation(), frames, joints);
  text += ",\n";
  AppendArray(text, "canonical", poses.canonical.positions(), frames, joints);
  text += ",\n";
  AppendArray(text, "rotation", poses.rotation, frames, 3);
  text += "\n}\n";
  WriteFileAtomically(path, text);
}

}  // namespace canonpose
