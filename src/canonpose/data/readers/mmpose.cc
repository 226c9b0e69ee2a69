#include "canonpose/data/readers/mmpose.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// The list of frames or people: the file itself, or instance_info of {meta_info, instance_info}.
JsonValue InstanceList(const JsonValue& root) {
  if (root.json().is_array()) return root;
  if (!root.Has("instance_info")) root.Fail("a list, or an object with instance_info", AdviseFormat(root));
  JsonValue list = root["instance_info"];
  if (!list.json().is_array()) list.Fail("a list of frames or of people");
  return list;
}

/// Whether a list contains the people of one image rather than the frames of a video. An empty list is an image without
/// people.
bool IsImage(const JsonValue& list) {
  return list.ArraySize() == 0 || (list.At(0).Has("keypoints") && !list.At(0).Has("image_id"));
}

bool IsFrameFileOfMmpose(const fs::path& file) {
  const JsonValue root = JsonValue::Load(file);
  return (root.json().is_array() || root.Has("instance_info")) && IsImage(InstanceList(root));
}

/// x, y, score triples from keypoints [[x, y], ...] and keypoint_scores [...].
std::vector<double> TriplesOf(const JsonValue& instance) {
  if (!instance.Has("keypoints") || !instance.Has("keypoint_scores")) {
    instance.Fail("an object with keypoints and keypoint_scores");
  }
  const JsonValue keypoints = instance["keypoints"];
  const JsonValue scores = instance["keypoint_scores"];
  const std::size_t count = keypoints.ArraySize();
  const std::vector<double> confidence = scores.Numbers();
  if (confidence.size() != count) {
    scores.Fail(fmt::format("{} values, one per keypoint", count), "", fmt::format("{} values", confidence.size()));
  }
  if (count == 0) keypoints.Fail("keypoints");
  std::vector<double> triples;
  triples.reserve(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    const JsonValue pair = keypoints.At(k);
    const std::vector<double> xy = pair.Numbers();
    if (xy.size() != 2) pair.Fail("two values (x, y)", "3D predictions are not 2D keypoints");
    triples.insert(triples.end(), {xy[0], xy[1], confidence[k]});
  }
  return triples;
}

void ReadPeople(const JsonValue& instances, DetectedFrame& frame, CameraBuilder& builder) {
  const std::size_t count = instances.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue instance = instances.At(i);
    std::optional<DetectedPerson> person = PersonFromTriples(TriplesOf(instance));
    if (!person) continue;
    if (const std::optional<JsonValue> score = instance.Find("bbox_score"); score && score->json().is_number()) {
      person->score = score->Number();
    }
    if (const std::optional<JsonValue> id = instance.Find("track_id"); id && id->json().is_number()) {
      person->track_id = id->Integer();
    }
    builder.Add(frame, std::move(*person), instance.file(), instance.place() + ".keypoints");
  }
}

void ReadMmposeFile(const fs::path& path, CameraBuilder& builder) {
  const JsonValue root = JsonValue::Load(path);
  const JsonValue list = InstanceList(root);
  if (IsImage(list)) {
    const std::string name = path.filename().string();
    ReadPeople(list, builder.Frame(LastNumber(name).value_or(0), name, list.file(), ""), builder);
    return;
  }
  const std::size_t count = list.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = list.At(i);
    if (!entry.Has("frame_id") || !entry.Has("instances")) {
      entry.Fail("an object with frame_id and instances", AdviseFormat(root));
    }
    // The place serves as the frame's name, so that two entries with one number are noticed.
    DetectedFrame& frame = builder.Frame(entry["frame_id"].Integer(), entry.place(), entry.file(), entry.place());
    ReadPeople(entry["instances"], frame, builder);
  }
}

}  // namespace

std::vector<CameraInput> FindMmposeCameras(const fs::path& path) { return FindFileCameras(path, IsFrameFileOfMmpose); }

DetectedCamera ReadMmpose(const CameraInput& input) {
  CameraBuilder builder(input);
  std::error_code error;
  if (!fs::is_directory(input.path, error)) {
    ReadMmposeFile(input.path, builder);
    return builder.Finish(false);
  }
  const std::vector<fs::path> files = JsonFilesIn(input.path);
  Progress progress("reading " + input.name, std::ssize(files));
  long done = 0;
  for (const fs::path& file : files) {
    FrameNumberOf(file.filename().string(), file.string(), "");
    ReadMmposeFile(file, builder);
    progress.Update(++done, "");
  }
  return builder.Finish(false);
}

}  // namespace canonpose
