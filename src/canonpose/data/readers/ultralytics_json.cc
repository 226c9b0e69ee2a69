// Ultralytics' results as JSON.
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/json_keys.h"
#include "canonpose/data/readers/ultralytics.h"

namespace canonpose::ultralytics {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAdvice =
    "save Results.to_json() of each frame: people with class, confidence, box and keypoints {x, y, visible}";
constexpr std::array<const char*, 2> kImageKeys{"image", "path"};
constexpr std::array<const char*, 6> kPeopleKeys{"detections", "results", "predictions",
                                                 "people",     "persons", "objects"};

/// The number of an entry's frame, or its image.
std::optional<JsonValue> FindFrame(const JsonValue& entry) {
  std::optional<JsonValue> frame = FindAny(entry, kFrameKeys);
  return frame ? frame : FindAny(entry, kImageKeys);
}

/// The people of a frame, or the frames of a file.
std::optional<JsonValue> FindList(const JsonValue& object) {
  std::optional<JsonValue> people = FindAny(object, kPeopleKeys);
  return people ? people : FindAnyList(object, kFrameListKeys);
}

/// Whether a value is a detection: it has a box and a class.
bool IsDetection(const JsonValue& value) { return value.Has("box") && (value.Has("class") || value.Has("name")); }

/// The class, of which 0 is a person; results of some versions have the name alone.
std::int64_t ClassOf(const JsonValue& detection) {
  if (const std::optional<JsonValue> number = detection.Find("class")) return number->Integer();
  return detection["name"].String() == "person" ? 0 : -1;
}

std::vector<double> TriplesOf(const JsonValue& keypoints) {
  const std::vector<double> x = keypoints["x"].NumbersOrNaN();
  const std::vector<double> y = keypoints["y"].NumbersOrNaN();
  const std::optional<JsonValue> visible = keypoints.Find("visible");
  const std::vector<double> confidence = visible ? visible->NumbersOrNaN() : std::vector<double>(x.size(), 1.0);
  if (x.empty() || x.size() != y.size() || x.size() != confidence.size()) {
    keypoints.Fail("as many x, y and visible", kAdvice,
                   fmt::format("{}, {} and {}", x.size(), y.size(), confidence.size()));
  }
  std::vector<double> triples;
  for (std::size_t k = 0; k < x.size(); ++k) triples.insert(triples.end(), {x[k], y[k], confidence[k]});
  return triples;
}

void AddDetection(const JsonValue& detection, DetectedFrame& frame, CameraBuilder& builder, OtherClasses& others) {
  if (!IsDetection(detection))
    detection.Fail("a detection with class, box and keypoints", kAdvice, detection.DescribeStructure());
  if (const std::int64_t number = ClassOf(detection); number != 0) {
    ++others[number];
    return;
  }
  if (!detection.Has("keypoints")) {
    detection.Fail("a detection with keypoints", "run a pose model, such as yolo11n-pose",
                   detection.DescribeStructure());
  }
  const std::vector<double> triples = TriplesOf(detection["keypoints"]);
  builder.NoteKeypointCount(triples.size() / 3);
  std::optional<DetectedPerson> person = PersonFromTriples(triples);
  if (!person) return;
  if (const std::optional<JsonValue> id = detection.Find("track_id")) person->track_id = id->Integer();
  if (const std::optional<JsonValue> score = detection.Find("confidence")) person->score = score->Number();
  builder.Add(frame, std::move(*person), detection.file(), detection.place());
}

void AddAll(const JsonValue& list, DetectedFrame& frame, CameraBuilder& builder, OtherClasses& others) {
  if (list.IsNull()) return;
  for (std::size_t i = 0; i < list.ArraySize(); ++i) AddDetection(list.At(i), frame, builder, others);
}

/// The frame that a value names.
DetectedFrame& NamedFrame(const JsonValue& name, const JsonValue& entry, bool is_shared, CameraBuilder& builder) {
  if (name.json().is_string())
    return builder.Frame(fs::path(name.String()).filename().string(), name.file(), name.place());
  return builder.Frame(name.Integer(), is_shared ? "" : entry.place(), name.file(), name.place());
}

void AddEntry(const JsonValue& entry, std::size_t index, CameraBuilder& builder, OtherClasses& others) {
  if (entry.json().is_array() || entry.IsNull()) {
    AddAll(entry, builder.Frame(static_cast<std::int64_t>(index), entry.place(), entry.file(), entry.place()), builder,
           others);
    return;
  }
  const std::optional<JsonValue> frame = FindFrame(entry);
  if (frame && IsDetection(entry)) {
    AddDetection(entry, NamedFrame(*frame, entry, true, builder), builder, others);
    return;
  }
  const std::optional<JsonValue> list = FindList(entry);
  if (!list) entry.Fail("the people of a frame", kAdvice, entry.DescribeStructure());
  if (frame) return AddAll(*list, NamedFrame(*frame, entry, false, builder), builder, others);
  AddAll(*list, builder.Frame(static_cast<std::int64_t>(index), entry.place(), entry.file(), entry.place()), builder,
         others);
}

}  // namespace

bool IsFrame(const JsonValue& root) {
  if (root.json().is_object()) {
    const std::optional<JsonValue> list = FindList(root);
    return list && list->json().is_array() && IsFrame(*list);
  }
  if (!root.json().is_array() || root.json().empty()) return false;
  const JsonValue first = root.At(0);
  return IsDetection(first) && first.Has("keypoints") && first["keypoints"].Has("x") && !FindFrame(first);
}

bool ReadJson(const JsonValue& root, CameraBuilder& builder, OtherClasses& others) {
  std::optional<JsonValue> list;
  if (root.json().is_array()) list = root;
  if (root.json().is_object()) list = FindList(root);
  if (list && list->json().is_array()) {
    const bool is_frame = list->json().empty() || (IsDetection(list->At(0)) && !FindFrame(list->At(0)));
    if (is_frame) {
      AddAll(*list, builder.Frame(fs::path(root.file()).filename().string(), root.file(), ""), builder, others);
      return true;
    }
    for (std::size_t i = 0; i < list->ArraySize(); ++i) AddEntry(list->At(i), i, builder, others);
    return true;
  }
  if (!root.json().is_object()) return false;
  const std::vector<std::string> keys = root.Keys();
  const bool are_frames = !keys.empty() && std::all_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return root[key].json().is_array() && key.find_first_of("0123456789") != std::string::npos;
  });
  if (!are_frames) return false;
  for (const std::string& key : keys) AddAll(root[key], builder.Frame(key, root.file(), key), builder, others);
  return true;
}

}  // namespace canonpose::ultralytics
