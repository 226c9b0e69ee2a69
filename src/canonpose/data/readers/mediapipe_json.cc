// MediaPipe's landmarks as JSON, in the forms that scripts dump them.
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/json_keys.h"
#include "canonpose/data/readers/mediapipe.h"
#include "canonpose/data/readers/mediapipe_layout.h"

namespace canonpose::mediapipe {
namespace {

namespace fs = std::filesystem;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kAdvice =
    "write a list with, for each frame, the 33 landmarks as {\"x\", \"y\", \"z\", \"visibility\"}, or null";

/// Under which a frame keeps its landmarks, the likeliest first.
constexpr std::array<const char*, 8> kLandmarkKeys{"pose_landmarks", "poseLandmarks", "landmarks", "landmark",
                                                   "keypoints",      "pose",          "poses",     "people"};

/// The landmarks of a frame; null where it says that it has none.
std::optional<JsonValue> FindLandmarks(const JsonValue& frame, const auto& keys) {
  if (std::optional<JsonValue> landmarks = FindAny(frame, keys)) return landmarks;
  const auto key = std::find_if(keys.begin(), keys.end(), [&](const char* name) { return frame.Contains(name); });
  return key == keys.end() ? std::nullopt : std::optional(frame[*key]);
}

/// Whether a value is one landmark: an object with x and y, or at least two numbers.
bool IsLandmark(const JsonValue& value) {
  if (value.json().is_object()) return value.Contains("x") && value.Contains("y");
  return value.json().is_array() && value.ArraySize() >= 2 && value.ArraySize() <= 5 &&
         (value.At(0).json().is_number() || value.At(0).IsNull());
}

/// How many numbers each landmark has in a list of the numbers of all; 0 where it is no such list.
std::size_t FlatWidth(const JsonValue& value) {
  if (value.ArraySize() == 0 || !value.At(0).json().is_number()) return 0;
  for (const std::size_t width : {4U, 3U, 2U}) {
    if (value.ArraySize() == width * kMediapipePoints) return width;
  }
  return 0;
}

/// Whether a value is the landmarks of one person: a list of them or of all their numbers, or an object of them by
/// name.
bool IsPerson(const JsonValue& value) {
  if (value.json().is_array()) return value.ArraySize() > 0 && (IsLandmark(value.At(0)) || FlatWidth(value) > 0);
  if (!value.json().is_object()) return false;
  const std::vector<std::string> keys = value.Keys();
  return std::any_of(keys.begin(), keys.end(),
                     [&](const std::string& key) { return FindLandmark(key).has_value() && IsLandmark(value[key]); });
}

double NumberOr(const std::optional<JsonValue>& value, double otherwise) { return value ? value->Number() : otherwise; }

/// x, y and confidence of a landmark.
std::array<double, 3> PointOf(const JsonValue& landmark) {
  if (landmark.IsNull()) return {kNaN, kNaN, 0.0};
  if (!IsLandmark(landmark)) landmark.Fail("a landmark {x, y, z, visibility}", kAdvice);
  if (landmark.json().is_array()) {
    const std::vector<double> values = landmark.NumbersOrNaN();
    return {values[0], values[1], values.size() > 3 ? values[3] : 1.0};
  }
  std::optional<JsonValue> confidence;
  for (const char* const key : {"visibility", "v", "confidence", "score"}) {
    if (!confidence) confidence = landmark.Find(key);
  }
  return {NumberOr(landmark.Find("x"), kNaN), NumberOr(landmark.Find("y"), kNaN), NumberOr(confidence, 1.0)};
}

std::vector<double> FlatTriples(const JsonValue& person, std::size_t width) {
  const std::vector<double> values = person.NumbersOrNaN();
  std::vector<double> triples;
  for (std::size_t i = 0; i < values.size(); i += width)
    triples.insert(triples.end(), {values[i], values[i + 1], width == 4 ? values[i + 3] : 1.0});
  return triples;
}

std::vector<double> TriplesOf(const JsonValue& person) {
  if (const std::size_t width = person.json().is_array() ? FlatWidth(person) : 0; width > 0)
    return FlatTriples(person, width);
  std::vector<double> triples(3 * kMediapipePoints, kNaN);
  const auto set = [&](std::size_t k, const JsonValue& landmark) {
    const std::array<double, 3> point = PointOf(landmark);
    std::copy(point.begin(), point.end(), triples.begin() + static_cast<std::ptrdiff_t>(3 * k));
  };
  if (person.json().is_array()) {
    if (person.ArraySize() != kMediapipePoints) {
      person.Fail(fmt::format("{} landmarks of MediaPipe's pose", kMediapipePoints),
                  "hands and faces have other landmarks, and no place here",
                  fmt::format("{} landmarks", person.ArraySize()));
    }
    for (std::size_t k = 0; k < kMediapipePoints; ++k) set(k, person.At(k));
  } else {
    for (const std::string& key : person.Keys()) {
      if (const std::optional<int> k = FindLandmark(key)) set(static_cast<std::size_t>(*k), person[key]);
    }
  }
  return triples;
}

/// Adds the people of a value that is one person, several, or an object that has them; `depth` ends what refers to
/// ever deeper members.
void ReadPeople(const JsonValue& value, DetectedFrame& frame, CameraBuilder& builder, int depth) {
  if (value.IsNull() || value.json().empty()) return;
  if (IsPerson(value)) {
    std::optional<DetectedPerson> person = PersonFromNamedTriples(TriplesOf(value));
    if (person) builder.Add(frame, std::move(*person), value.file(), value.place());
    return;
  }
  if (value.json().is_array() && depth > 0) {
    for (std::size_t i = 0; i < value.ArraySize(); ++i) ReadPeople(value.At(i), frame, builder, depth - 1);
    return;
  }
  const std::optional<JsonValue> inside = depth > 0 ? FindLandmarks(value, kLandmarkKeys) : std::nullopt;
  if (inside) return ReadPeople(*inside, frame, builder, depth - 1);
  const bool is_world = value.Has("pose_world_landmarks");
  value.Fail("MediaPipe's landmarks of a person",
             is_world ? "dump pose_landmarks: pose_world_landmarks are metres, not places in the image" : kAdvice,
             value.DescribeStructure());
}

constexpr int kDepth = 3;

/// The frame of an entry: by its own number or image, otherwise by its place in the list.
DetectedFrame& FrameOf(const JsonValue& entry, std::size_t index, CameraBuilder& builder) {
  std::optional<JsonValue> number = FindAny(entry, kFrameKeys);
  if (!number) number = entry.Find("index");
  if (number && number->json().is_number())
    return builder.Frame(number->Integer(), entry.place(), entry.file(), entry.place());
  if (number && number->json().is_string())
    return builder.Frame(fs::path(number->String()).filename().string(), entry.file(), entry.place());
  return builder.Frame(static_cast<std::int64_t>(index), entry.place(), entry.file(), entry.place());
}

bool IsWhole(const std::string& key) {
  return !key.empty() && key.size() < 18 && key.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

bool IsFrame(const JsonValue& root) {
  return IsPerson(root) || (root.json().is_object() && FindLandmarks(root, kLandmarkKeys)) ||
         root.Has("pose_world_landmarks");
}

bool IsTypicalFrame(const JsonValue& root) {
  if (IsPerson(root)) {
    return root.json().is_object() || root.ArraySize() == kMediapipePoints || FlatWidth(root) > 0;
  }
  // "keypoints" and "people" are other detectors', too.
  const std::optional<JsonValue> inside =
      FindLandmarks(root, std::array{"pose_landmarks", "poseLandmarks", "landmarks"});
  return inside.has_value() || root.Has("pose_world_landmarks");
}

namespace {

/// Adds the frames of a value, or of the list of frames that it has, which may have another; `depth` ends that.
bool ReadFrames(const JsonValue& root, CameraBuilder& builder, int depth) {
  if (const std::optional<JsonValue> list = FindAnyList(root, kFrameListKeys))
    return depth > 0 && ReadFrames(*list, builder, depth - 1);
  const std::string file_name = fs::path(root.file()).filename().string();
  if (IsFrame(root)) {
    ReadPeople(root, builder.Frame(file_name, root.file(), ""), builder, kDepth);
    return true;
  }
  if (root.json().is_array()) {
    for (std::size_t i = 0; i < root.ArraySize(); ++i) {
      ReadPeople(root.At(i), FrameOf(root.At(i), i, builder), builder, kDepth);
    }
    return true;
  }
  if (!root.json().is_object()) return false;
  const std::vector<std::string> keys = root.Keys();
  if (keys.empty() || !std::all_of(keys.begin(), keys.end(), IsWhole)) return false;
  for (const std::string& key : keys) {
    std::int64_t number = 0;
    std::from_chars(key.data(), key.data() + key.size(), number);
    const JsonValue entry = root[key];
    ReadPeople(entry, builder.Frame(number, entry.place(), entry.file(), entry.place()), builder, kDepth);
  }
  return true;
}

}  // namespace

bool ReadJson(const JsonValue& root, CameraBuilder& builder) { return ReadFrames(root, builder, kDepth); }

}  // namespace canonpose::mediapipe
