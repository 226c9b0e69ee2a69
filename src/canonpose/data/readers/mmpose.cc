#include "canonpose/data/readers/mmpose.h"

#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// The list of frames or people: the file itself, instance_info of {meta_info, instance_info}, or the predictions of
/// one image as MMPoseInferencer returns them, {visualization, predictions: [[...]]}.
JsonValue InstanceList(const JsonValue& root) {
  if (root.json().is_array()) return root;
  if (const std::optional<JsonValue> predictions = root.Find("predictions")) {
    if (!predictions->json().is_array()) predictions->Fail("a list of people, or of lists of them");
    const bool is_nested = !predictions->json().empty() && predictions->At(0).json().is_array();
    return is_nested ? predictions->At(0) : *predictions;
  }
  if (!root.Has("instance_info")) FailFormat(root, "a list, or an object with instance_info");
  JsonValue list = root["instance_info"];
  if (!list.json().is_array()) list.Fail("a list of frames or of people");
  return list;
}

bool IsPerson(const JsonValue& value) { return value.Contains("keypoints") && !value.Has("image_id"); }

/// Whether a list contains the people of one image rather than the frames of a video. An empty list is an image without
/// people.
bool IsImage(const JsonValue& list) { return list.ArraySize() == 0 || IsPerson(list.At(0)); }

bool IsFrameFileOfMmpose(const fs::path& file) {
  const char first = FirstCharacter(file);
  if (first != '{' && first != '[') return false;
  const JsonValue root = JsonValue::Load(file);
  return (root.json().is_array() || root.Has("instance_info") || root.Has("predictions")) &&
         IsImage(InstanceList(root));
}

/// x, y, score triples from keypoints [[x, y], ...] and keypoint_scores [...], or from keypoints [[x, y, score], ...]
/// as in MMPose 0.x. NaN where the file has null or NaN.
std::vector<double> TriplesOf(const JsonValue& instance) {
  const JsonValue keypoints = instance["keypoints"];
  const std::size_t count = keypoints.ArraySize();
  if (count == 0) keypoints.Fail("keypoints");
  std::vector<double> confidence;
  if (const std::optional<JsonValue> scores = instance.Find("keypoint_scores")) {
    confidence = scores->NumbersOrNaN();
    if (confidence.size() != count) {
      scores->Fail(fmt::format("{} values, one per keypoint", count), "", fmt::format("{} values", confidence.size()));
    }
  }
  std::vector<double> triples;
  triples.reserve(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    const JsonValue value = keypoints.At(k);
    if (value.IsNull()) {
      triples.insert(triples.end(), 3, std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const std::vector<double> point = value.NumbersOrNaN();
    if (confidence.empty() && point.size() != 3) {
      if (point.size() == 2)
        instance.Fail("an object with keypoints and keypoint_scores", "", instance.DescribeStructure());
      value.Fail("three values (x, y, score), or two and keypoint_scores");
    }
    if (!confidence.empty() && point.size() != 2)
      value.Fail("two values (x, y)", "3D predictions are not 2D keypoints");
    triples.insert(triples.end(), {point[0], point[1], confidence.empty() ? point[2] : confidence[k]});
  }
  return triples;
}

void ReadPeople(const JsonValue& instances, DetectedFrame& frame, CameraBuilder& builder) {
  const std::size_t count = instances.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue instance = instances.At(i);
    if (!instance.Contains("keypoints"))
      instance.Fail("an object with keypoints and keypoint_scores", "", instance.DescribeStructure());
    if (instance["keypoints"].IsNull()) continue;
    const std::vector<double> triples = TriplesOf(instance);
    builder.NoteKeypointCount(triples.size() / 3);
    std::optional<DetectedPerson> person = PersonFromTriples(triples);
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

/// The people of a video's frames: {frame_id, instances}, or, as MMPose returns them in memory, lists of people or
/// {visualization, predictions} in order.
void ReadFrames(const JsonValue& list, CameraBuilder& builder) {
  const std::size_t count = list.ArraySize();
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = list.At(i);
    // The place serves as the frame's name, so that two entries with one number are noticed.
    if (entry.json().is_array()) {
      ReadPeople(entry, builder.Frame(static_cast<std::int64_t>(i), entry.place(), entry.file(), entry.place()),
                 builder);
    } else if (entry.Has("predictions")) {
      ReadPeople(InstanceList(entry),
                 builder.Frame(static_cast<std::int64_t>(i), entry.place(), entry.file(), entry.place()), builder);
    } else if (entry.Has("frame_id") && entry.Has("instances")) {
      ReadPeople(entry["instances"],
                 builder.Frame(entry["frame_id"].Integer(), entry.place(), entry.file(), entry.place()), builder);
    } else {
      if (i == 0) FailFormat(list, "a list of objects with frame_id and instances");
      entry.Fail("an object with frame_id and instances", "", entry.DescribeStructure());
    }
  }
}

/// Reads one image's file of a folder; returns false where it has no keypoints.
bool ReadImageFile(const JsonValue& root, CameraBuilder& builder) {
  if (GuessFormat(root).empty() && !(root.json().is_array() && root.json().empty()) && !root.Has("instance_info"))
    return false;
  const JsonValue list = InstanceList(root);
  if (IsImage(list)) {
    const std::string name = fs::path(root.file()).filename().string();
    ReadPeople(list, builder.Frame(name, root.file(), ""), builder);
  } else {
    ReadFrames(list, builder);
  }
  return true;
}

}  // namespace

std::vector<CameraInput> FindMmposeCameras(const fs::path& path) { return FindFileCameras(path, IsFrameFileOfMmpose); }

DetectedCamera ReadMmpose(const CameraInput& input) {
  CameraBuilder builder(input);
  std::error_code error;
  if (fs::is_directory(input.path, error)) {
    ReadFrameFiles(input, builder, ReadImageFile, "the people of one image, as MMPose writes them");
    return builder.Finish(false);
  }
  const JsonValue root = JsonValue::Load(input.path);
  const JsonValue list = InstanceList(root);
  if (IsImage(list)) {
    const std::string name = input.path.filename().string();
    ReadPeople(list, builder.Frame(0, name, root.file(), ""), builder);
  } else {
    ReadFrames(list, builder);
  }
  return builder.Finish(false);
}

}  // namespace canonpose
