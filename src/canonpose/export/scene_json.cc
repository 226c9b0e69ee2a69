#include "canonpose/export/scene_json.h"

#include <fmt/format.h>

#include "canonpose/analyse/filter.h"
#include "canonpose/export/json_text.h"
#include "canonpose/export/nested_json.h"
#include "canonpose/export/person_names.h"
#include "canonpose/export/scene_arrays.h"

namespace canonpose {
namespace {

std::string SourceJson(const Provenance& provenance) {
  return provenance.is_known() ? JsonText(provenance.source) : "null";
}

std::string PersonJson(const PoseSequence& person, const std::string& name, const FileSpace& space) {
  const auto frames = static_cast<std::size_t>(person.frame_count());
  const auto joints = static_cast<std::size_t>(person.joint_count());
  std::string text = "    {\n";
  text += fmt::format("      \"name\": {},\n", JsonText(name));
  text += fmt::format("      \"joints\": {},\n", JsonText(person.skeleton().joints));
  text += fmt::format("      \"parents\": {},\n", JsonText(person.skeleton().parents));
  text += fmt::format("      \"positions\": {},\n", NestedJson(PositionsInFile(person, space), {frames, joints, 3}, 8));
  text += fmt::format("      \"confidence\": {},\n", NestedJson(person.confidence(), {frames, joints}, 8));
  text += fmt::format("      \"standard_deviation\": {}\n",
                      NestedJson(DeviationsInFile(person, space), {frames, joints}, 8));
  return text + "    }";
}

std::string SceneCameraJson(const SceneCamera& camera, const FileSpace& space) {
  std::string text = "    {\n";
  text += fmt::format("      \"name\": {},\n", JsonText(camera.name));
  text += fmt::format("      \"image_size\": {},\n", JsonText(camera.image_size_px));
  text += fmt::format("      \"time_offset_seconds\": {},\n", JsonText(camera.time_offset_seconds));
  text += fmt::format("      \"used\": {},\n", camera.used);
  text += fmt::format("      \"why_not_used\": {},\n", camera.used ? "null" : JsonText(camera.why_not_used));
  const CameraArrays arrays = ArraysOfCameras(camera.calibration, space);
  const auto add = [&](const char* key, const std::vector<double>& values, std::vector<std::size_t> shape) {
    if (camera.calibration.size() > 1) shape.insert(shape.begin(), camera.calibration.size());
    text += fmt::format(",\n      \"{}\": {}", key, camera.calibration.empty() ? "null" : NestedJson(values, shape, 8));
  };
  text.resize(text.size() - 2);
  add("K", arrays.K, {3, 3});
  add("R", arrays.R, {3, 3});
  add("t", arrays.t, {3});
  add("distortion", arrays.distortion, {5});
  return text + "\n    }";
}

}  // namespace

std::string SceneJson(const Scene& scene, const FileSpace& space, const std::string& processing) {
  const PoseSequence& first = scene.people.front();
  const double fps = FrameRateOf(first);
  std::string text = "{\n  \"format\": \"canonpose-scene-json\",\n  \"version\": 1,\n";
  text += fmt::format("  \"name\": {},\n", JsonText(scene.name));
  text += fmt::format("  \"unit\": {},\n  \"unit_from\": {},\n", JsonText(space.unit()), SourceJson(scene.scale));
  text += fmt::format("  \"up\": {},\n  \"up_from\": {},\n", JsonText(space.up()), SourceJson(scene.up));
  text += fmt::format("  \"processing\": {},\n", processing.empty() ? "null" : JsonText(processing));
  text += fmt::format("  \"fps\": {},\n", fps > 0.0 ? JsonText(fps) : "null");
  text += fmt::format("  \"time\": {},\n", JsonText(SecondsOf(first)));  // NaN becomes null
  text += "  \"people\": [\n";
  const std::vector<std::string> names = PersonNames(scene);
  for (std::size_t p = 0; p < names.size(); ++p) {
    text += PersonJson(scene.people[p], names[p], space) + (p + 1 < names.size() ? ",\n" : "\n");
  }
  text += "  ],\n  \"cameras\": [\n";
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    text += SceneCameraJson(scene.cameras[c], space) + (c + 1 < scene.cameras.size() ? ",\n" : "\n");
  }
  return text + "  ]\n}\n";
}

}  // namespace canonpose
