#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/export/json_text.h"
#include "canonpose/export/lift_output.h"
#include "canonpose/export/nested_json.h"

namespace canonpose {

void WriteLiftJson(const std::filesystem::path& path, const LiftedPoses& poses) {
  const std::size_t frames = poses.frames.size();
  const std::size_t joints = poses.skeleton().joints.size();
  std::string text = "{\n";
  text += fmt::format("  \"units\": {},\n", JsonText(UnitsInFile(poses)));
  const double fps = poses.pose_in_camera.fps;
  if (fps > 0.0) text += fmt::format("  \"fps\": {},\n", JsonText(fps));
  text += fmt::format("  \"joints\": {},\n", JsonText(poses.skeleton().joints));
  text += fmt::format("  \"parents\": {},\n", JsonText(poses.skeleton().parents));
  text += fmt::format("  \"frames\": {},\n", JsonText(poses.frames));
  nlohmann::json seconds = nlohmann::json::array();
  for (const std::int64_t frame : poses.frames) {
    seconds.push_back(fps > 0.0 ? nlohmann::json(static_cast<double>(frame) / fps) : nlohmann::json());
  }
  text += fmt::format("  \"time\": {},\n", JsonText(seconds));
  const auto add = [&](const char* key, const std::vector<float>& values, const std::vector<std::size_t>& shape) {
    text += fmt::format("  \"{}\": {}", key, NestedJson(values, shape, 4));
  };
  add("pose3d", poses.pose_in_camera.positions(), {frames, joints, 3});
  text += ",\n";
  add("confidence", poses.pose_in_camera.confidence(), {frames, joints});
  text += ",\n";
  add("standard_deviation", poses.pose_in_camera.standard_deviation(), {frames, joints});
  text += ",\n";
  add("canonical", poses.canonical.positions(), {frames, joints, 3});
  text += ",\n";
  add("rotation", poses.rotation, {frames, 3, 3});
  text += "\n}\n";
  WriteFileAtomically(path, text);
}

}  // namespace canonpose
