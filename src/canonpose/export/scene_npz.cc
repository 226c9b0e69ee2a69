#include "canonpose/export/scene_npz.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/export/person_names.h"
#include "canonpose/export/scene_arrays.h"

namespace canonpose {
namespace {

void AddPeople(const Scene& scene, const FileSpace& space, NpzWriter& writer) {
  const PoseSequence& first = scene.people.front();
  const auto frames = static_cast<std::size_t>(first.frame_count());
  const auto joints = static_cast<std::size_t>(first.joint_count());
  std::vector<float> positions;
  std::vector<float> confidence;
  std::vector<float> deviations;
  const auto extend = [](std::vector<float>& all, const std::vector<float>& values) {
    all.insert(all.end(), values.begin(), values.end());
  };
  for (const PoseSequence& person : scene.people) {
    if (person.skeleton().joints != first.skeleton().joints) {
      ThrowInvalidArgument("{} and {} have different joints: export one `person` at a time", first.name, person.name);
    }
    extend(positions, PositionsInFile(person, space));
    extend(confidence, person.confidence());
    extend(deviations, DeviationsInFile(person, space));
  }
  writer.Add("positions", positions, {scene.people.size(), frames, joints, 3});
  writer.Add("confidence", confidence, {scene.people.size(), frames, joints});
  writer.Add("standard_deviation", deviations, {scene.people.size(), frames, joints});
  writer.Add("time", SecondsOf(first), {frames});
  if (const double fps = FrameRateOf(first); fps > 0.0) writer.Add("fps", std::vector<double>{fps}, {});
  writer.AddStrings("people", PersonNames(scene));
  writer.AddStrings("joints", first.skeleton().joints);
  const std::vector<std::int64_t> parents(first.skeleton().parents.begin(), first.skeleton().parents.end());
  writer.Add("parents", parents, {joints});
}

void AddCameras(const Scene& scene, const FileSpace& space, NpzWriter& writer) {
  std::size_t frames = 1;
  for (const SceneCamera& camera : scene.cameras) frames = std::max(frames, camera.calibration.size());
  CameraArrays all;
  std::vector<std::string> names;
  std::vector<std::int64_t> sizes;
  const auto extend = [&](std::vector<double>& values, const std::vector<double>& own, std::size_t width) {
    // One camera stands for all frames; none for nothing known.
    if (own.empty()) values.insert(values.end(), frames * width, std::numeric_limits<double>::quiet_NaN());
    const std::size_t copies = own.size() == width ? frames : 1;
    for (std::size_t i = 0; i < copies; ++i) values.insert(values.end(), own.begin(), own.end());
  };
  for (const SceneCamera& camera : scene.cameras) {
    names.push_back(camera.name);
    sizes.insert(sizes.end(), camera.image_size_px.begin(), camera.image_size_px.end());
    const CameraArrays own = ArraysOfCameras(camera.calibration, space);
    extend(all.K, own.K, 9);
    extend(all.R, own.R, 9);
    extend(all.t, own.t, 3);
    extend(all.distortion, own.distortion, 5);
  }
  const auto add = [&](const char* name, const std::vector<double>& values, std::vector<std::size_t> shape) {
    if (frames > 1) shape.insert(shape.begin(), frames);
    shape.insert(shape.begin(), names.size());
    writer.Add(name, values, shape);
  };
  writer.AddStrings("cameras", names);
  writer.Add("image_size", sizes, {names.size(), 2});
  add("K", all.K, {3, 3});
  add("R", all.R, {3, 3});
  add("t", all.t, {3});
  add("distortion", all.distortion, {5});
}

}  // namespace

void WriteSceneNpz(const std::filesystem::path& path, const Scene& scene, const FileSpace& space,
                   const std::string& processing) {
  NpzWriter writer(path);
  AddPeople(scene, space, writer);
  if (!scene.cameras.empty()) AddCameras(scene, space, writer);
  writer.AddString("unit", space.unit());
  writer.AddString("unit_from", scene.scale.source);
  writer.AddString("up", space.up());
  writer.AddString("up_from", scene.up.source);
  writer.AddString("processing", processing);
  writer.AddString("name", scene.name);
  writer.Commit();
}

}  // namespace canonpose
