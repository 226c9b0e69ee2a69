#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/scene/camera_file.h"
#include "canonpose/scene/provenance_file.h"
#include "canonpose/scene/scene.h"
#include "canonpose/scene/skeleton_file.h"

namespace canonpose {
namespace {

constexpr const char* kFormat = "canonpose-scene";
constexpr std::int64_t kVersion = 1;

LengthUnit ReadUnit(const h5::Group& group) {
  const std::string text = group.GetString("unit");
  for (const LengthUnit unit : {LengthUnit::kMillimetres, LengthUnit::kBodyLengths, LengthUnit::kEachItsOwn}) {
    if (text == ToString(unit)) return unit;
  }
  group.Fail("attribute unit", "\"mm\", \"body lengths\" or \"each pose its own\"", '"' + text + '"', "");
}

std::vector<float> ReadValues(const h5::Group& group, const std::string& name, const std::vector<std::size_t>& shape) {
  const std::vector<std::size_t> found = group.Shape(name);
  if (found != shape) group.Fail(name, "shape " + h5::FormatShape(shape), h5::FormatShape(found), "");
  return group.Read<float>(name).values;
}

double ReadFinite(const h5::Group& group, const std::string& name) {
  const double value = group.GetDouble(name);
  if (!std::isfinite(value)) group.Fail("attribute " + name, "a finite number", fmt::format("{}", value), "");
  return value;
}

PoseSequence ReadPerson(const h5::Group& group) {
  Skeleton skeleton = ReadSkeleton(group.Open("skeleton"));
  const std::size_t joints = skeleton.joints.size();
  const std::vector<std::size_t> shape = group.Shape("positions");
  if (shape.size() != 3 || shape[0] > INT32_MAX || shape[1] != joints || shape[2] != 3) {
    group.Fail("positions", fmt::format("shape (T, {}, 3) = frames, joints, x y z", joints), h5::FormatShape(shape),
               "");
  }
  PoseSequence person(std::move(skeleton), static_cast<int>(shape[0]));
  person.name = group.GetString("name");
  person.unit = ReadUnit(group);
  person.fps = ReadFinite(group, "fps");
  if (person.fps < 0.0) group.Fail("attribute fps", "0 or more", fmt::format("{}", person.fps), "");
  person.positions() = ReadValues(group, "positions", shape);
  person.confidence() = ReadValues(group, "confidence", {shape[0], joints});
  person.standard_deviation() = ReadValues(group, "standard_deviation", {shape[0], joints});
  for (const float value : person.positions()) {
    if (std::isinf(value)) group.Fail("positions", "coordinates, or NaN where unknown", "an infinite one", "");
  }
  for (const float value : person.confidence()) {
    if (!(value >= 0.0F && value <= 1.0F))
      group.Fail("confidence", "numbers from 0 to 1", fmt::format("{}", value), "");
  }
  if (group.Has("time_seconds")) {
    if (group.Shape("time_seconds") != std::vector{shape[0]}) {
      group.Fail("time_seconds", fmt::format("shape ({}) = frames", shape[0]),
                 h5::FormatShape(group.Shape("time_seconds")), "");
    }
    person.time_seconds = group.Read<double>("time_seconds").values;
    if (!std::ranges::is_sorted(person.time_seconds) ||
        !std::ranges::all_of(person.time_seconds, [](double seconds) { return std::isfinite(seconds); })) {
      group.Fail("time_seconds", "finite times in ascending order", "others", "");
    }
  }
  return person;
}

SceneCamera ReadSceneCamera(const h5::Group& group, int frame_count) {
  SceneCamera camera;
  camera.name = group.GetString("name");
  const std::vector<std::int64_t> size = group.GetInts("image_size");
  if (size.size() != 2 || size[0] < 0 || size[1] < 0 || size[0] > INT32_MAX || size[1] > INT32_MAX) {
    group.Fail("attribute image_size", "width and height in pixels", "something else", "");
  }
  camera.image_size_px = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  camera.time_offset_seconds = ReadFinite(group, "time_offset_seconds");
  camera.used = group.GetInt("used") != 0;
  camera.why_not_used = group.GetString("why_not_used");
  camera.calibration = ReadCameras(group, frame_count);
  return camera;
}

void CheckFormat(const h5::Group& root) {
  const std::string format = root.HasAttribute("format") ? root.GetString("format") : "";
  if (format != kFormat) {
    root.Fail("attribute format", fmt::format("\"{}\"", kFormat), format.empty() ? "nothing" : '"' + format + '"', "");
  }
  const std::int64_t version = root.GetInt("version");
  if (version != kVersion) {
    root.Fail("attribute version", fmt::format("{}", kVersion), fmt::format("{}", version),
              version > kVersion ? "a newer version of canonpose wrote the file: update this one" : "");
  }
}

/// People and cameras are groups 0, 1, ...; HDF5 sorts names as text.
std::vector<std::string> InOrderOfNumber(const h5::Group& group) {
  std::vector<std::string> names = group.Children();
  std::ranges::stable_sort(names, {}, [](const std::string& name) { return std::pair(name.size(), name); });
  return names;
}

template <typename T>
void WriteValues(h5::Group& group, const std::string& name, const std::vector<T>& values,
                 const std::vector<std::size_t>& shape) {
  group.Write<T>(name, std::span<const T>(values), shape);
}

void WritePerson(h5::Group group, const PoseSequence& person) {
  const auto frames = static_cast<std::size_t>(person.frame_count());
  const auto joints = static_cast<std::size_t>(person.joint_count());
  group.SetString("name", person.name);
  group.SetString("unit", ToString(person.unit));
  group.SetDouble("fps", person.fps);
  h5::Group skeleton = group.Create("skeleton");
  WriteSkeleton(skeleton, person.skeleton());
  WriteValues(group, "positions", person.positions(), {frames, joints, 3});
  WriteValues(group, "confidence", person.confidence(), {frames, joints});
  WriteValues(group, "standard_deviation", person.standard_deviation(), {frames, joints});
  if (!person.time_seconds.empty()) WriteValues(group, "time_seconds", person.time_seconds, {frames});
}

void WriteSceneCamera(h5::Group group, const SceneCamera& camera) {
  group.SetString("name", camera.name);
  group.SetInts("image_size", {camera.image_size_px[0], camera.image_size_px[1]});
  group.SetDouble("time_offset_seconds", camera.time_offset_seconds);
  group.SetInt("used", camera.used ? 1 : 0);
  group.SetString("why_not_used", camera.why_not_used);
  WriteCameras(group, camera.calibration);
}

}  // namespace

Scene ReadScene(const std::filesystem::path& path) {
  h5::File file = h5::File::OpenForReading(path);
  const h5::Group& root = file.root();
  CheckFormat(root);
  Scene scene;
  scene.name = root.GetString("name");
  const WorldProvenance world = ReadWorldProvenance(root);
  scene.up = world.up;
  scene.floor = world.floor;
  scene.scale = world.scale;
  const h5::Group people = root.Open("people");
  for (const std::string& number : InOrderOfNumber(people)) {
    scene.people.push_back(ReadPerson(people.Open(number)));
    const PoseSequence& first = scene.people.front();
    const PoseSequence& person = scene.people.back();
    if (person.frame_count() != first.frame_count() || person.unit != first.unit || person.fps != first.fps ||
        person.time_seconds != first.time_seconds) {
      people.Fail(number, "the frames, times and unit of the first person", "others", "");
    }
  }
  const int frames = scene.people.empty() ? 1 : scene.people.front().frame_count();
  const h5::Group cameras = root.Open("cameras");
  for (const std::string& number : InOrderOfNumber(cameras)) {
    scene.cameras.push_back(ReadSceneCamera(cameras.Open(number), frames));
  }
  return scene;
}

bool IsSceneFile(const std::filesystem::path& path) {
  if (!h5::File::IsHdf5(path)) return false;
  h5::File file = h5::File::OpenForReading(path);
  try {
    return file.root().HasAttribute("format") && file.root().GetString("format") == kFormat;
  } catch (const Error&) {
    return false;  // an attribute of that name which is not text belongs to someone else's format
  }
}

void WriteScene(const std::filesystem::path& path, const Scene& scene) {
  scene.Validate();
  h5::File file = h5::File::CreateAt(path);
  {
    h5::Group& root = file.root();
    root.SetString("format", kFormat);
    root.SetInt("version", kVersion);
    root.SetString("name", scene.name);
    // Readers of the first files expect these two even where nothing is known.
    if (!scene.up.is_known()) root.SetString("up", "");
    if (!scene.scale.is_known()) root.SetString("scale", "");
    WriteWorldProvenance(root, {scene.up, scene.floor, scene.scale});
    h5::Group people = root.Create("people");
    for (std::size_t i = 0; i < scene.people.size(); ++i) {
      WritePerson(people.Create(fmt::format("{}", i)), scene.people[i]);
    }
    h5::Group cameras = root.Create("cameras");
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
      WriteSceneCamera(cameras.Create(fmt::format("{}", i)), scene.cameras[i]);
    }
  }
  file.Commit();
}

}  // namespace canonpose
