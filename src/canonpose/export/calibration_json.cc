#include <fmt/format.h>

#include "canonpose/export/calibration_text.h"
#include "canonpose/export/json_text.h"
#include "canonpose/export/nested_json.h"
#include "canonpose/export/scene_arrays.h"

namespace canonpose {

std::string JsonCalibration(const Scene& scene, const FileSpace& space) {
  std::string text = fmt::format("{{\n  \"units\": {},\n  \"up\": {},\n", JsonText(space.unit()), JsonText(space.up()));
  text +=
      "  \"convention\": \"x_camera = R * x_world + t; pixel = K * distort(x_camera / z); x right, y down, z "
      "forward\",\n";
  text += "  \"distortion_model\": \"Brown-Conrady k1 k2 p1 p2 k3\",\n  \"cameras\": {";
  bool is_first = true;
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.empty()) continue;
    const CameraArrays arrays = ArraysOfCameras(camera.calibration, space);
    text += fmt::format("{}\n    {}: {{\n      \"image_size\": {}", is_first ? "" : ",", JsonText(camera.name),
                        JsonText(camera.image_size_px));
    is_first = false;
    const auto add = [&](const char* key, const std::vector<double>& values, std::vector<std::size_t> shape) {
      if (camera.calibration.size() > 1) shape.insert(shape.begin(), camera.calibration.size());
      text += fmt::format(",\n      \"{}\": {}", key, NestedJson(values, shape, 8));
    };
    add("K", arrays.K, {3, 3});
    add("R", arrays.R, {3, 3});
    add("t", arrays.t, {3});
    add("distortion", arrays.distortion, {5});
    text += "\n    }";
  }
  return text + "\n  }\n}\n";
}

}  // namespace canonpose
