#include "canonpose/data/lifted_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/scene/lifted_scene.h"

namespace canonpose {
namespace {

/// The arrays of a file, before they are checked against each other.
struct LiftedArrays {
  std::string units;
  double fps = 0.0;
  std::vector<std::string> joints;
  std::vector<int> parents;
  std::vector<std::int64_t> frames;
  std::vector<float> positions;           // (T, J, 3)
  std::vector<float> confidence;          // (T, J)
  std::vector<float> standard_deviation;  // (T, J)
};

constexpr const char* kAdvice = "lift the video again";
/// The index of a parent that cannot be one; Skeleton::Problem() finds it.
constexpr int kNoJoint = -2;

[[noreturn]] void ThrowDamaged(const std::string& file, const std::string& place, const std::string& expected,
                               const std::string& found) {
  ThrowBadInput({file, place, expected, found, kAdvice});
}

LiftedArrays FromNpz(const std::filesystem::path& path) {
  const NpzReader reader(path);
  if (!reader.Has("pose3d") || !reader.Has("units")) {
    ThrowBadInput({path.string(), "", "poses that `canonpose lift` wrote", "other arrays",
                   "give a solved dataset, a scene, or a file of `canonpose lift`"});
  }
  LiftedArrays arrays;
  const std::vector<std::string> units = reader.ReadStrings("units");
  if (units.size() != 1) ThrowDamaged(path.string(), "array units", "one text", fmt::format("{}", units.size()));
  arrays.units = units.front();
  std::vector<std::size_t> shape;
  const auto read = [&](const char* name) { return reader.ReadFloats(name, &shape); };
  if (reader.Has("fps")) {
    const std::vector<float> fps = read("fps");
    if (fps.size() != 1) ThrowDamaged(path.string(), "array fps", "one number", fmt::format("{}", fps.size()));
    // As float, 29.97 would become another number.
    const NpyArray array = reader.Read("fps");
    const auto* exact = std::get_if<std::vector<double>>(&array.values);
    arrays.fps = exact != nullptr ? exact->front() : fps.front();
  }
  arrays.joints = reader.ReadStrings("joints");
  for (const float parent : read("parents")) {
    const bool is_index = parent >= -1.0F && parent < 1e6F;
    arrays.parents.push_back(is_index ? static_cast<int>(parent) : kNoJoint);
  }
  const NpyArray frames = reader.Read("frames");
  if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&frames.values)) {
    arrays.frames = *numbers;
  } else {
    ThrowDamaged(path.string(), "array frames", "int64", "another type");
  }
  arrays.confidence = read("confidence");
  arrays.standard_deviation = read("standard_deviation");
  arrays.positions = read("pose3d");
  return arrays;
}

/// The numbers of an array of arrays of arrays and so on, `depth` deep.
void AppendNested(const JsonValue& value, int depth, std::vector<float>& numbers) {
  if (depth > 1) {
    for (std::size_t i = 0; i < value.ArraySize(); ++i) AppendNested(value.At(i), depth - 1, numbers);
    return;
  }
  for (const double number : value.NumbersOrNaN()) numbers.push_back(static_cast<float>(number));
}

LiftedArrays FromJson(const std::filesystem::path& path) {
  const JsonValue root = JsonValue::Load(path);
  if (!root.Has("pose3d") || !root.Has("units")) {
    root.Fail("poses that `canonpose lift` wrote", "give a solved dataset, a scene, or a file of `canonpose lift`",
              root.DescribeStructure());
  }
  LiftedArrays arrays;
  arrays.units = root["units"].String();
  if (const std::optional<JsonValue> fps = root.Find("fps")) arrays.fps = fps->Number();
  const JsonValue joints = root["joints"];
  for (std::size_t j = 0; j < joints.ArraySize(); ++j) arrays.joints.push_back(joints.At(j).String());
  const JsonValue parents = root["parents"];
  for (std::size_t j = 0; j < parents.ArraySize(); ++j) {
    const std::int64_t parent = parents.At(j).Integer();
    arrays.parents.push_back(parent >= -1 && parent < 1'000'000 ? static_cast<int>(parent) : kNoJoint);
  }
  const JsonValue frames = root["frames"];
  for (std::size_t t = 0; t < frames.ArraySize(); ++t) arrays.frames.push_back(frames.At(t).Integer());
  AppendNested(root["pose3d"], 3, arrays.positions);
  AppendNested(root["confidence"], 2, arrays.confidence);
  AppendNested(root["standard_deviation"], 2, arrays.standard_deviation);
  return arrays;
}

/// "RKnee" for "LKnee", "right_knee" for "left_knee".
std::string OtherSide(const std::string& joint) {
  for (const auto& [left, right] :
       {std::pair("left", "right"), std::pair("Left", "Right"), std::pair("L", "R"), std::pair("l", "r")}) {
    for (const auto& [from, to] : {std::pair(left, right), std::pair(right, left)}) {
      if (joint.starts_with(from)) return to + joint.substr(std::string(from).size());
    }
  }
  return joint;
}

/// The files do not say which joints are partners: the built-in skeletons do, and otherwise names.
Skeleton SkeletonOf(const LiftedArrays& arrays, const std::string& file) {
  Skeleton skeleton;
  skeleton.joints = arrays.joints;
  skeleton.parents = arrays.parents;
  const auto root = std::ranges::find(arrays.parents, -1);
  if (root == arrays.parents.end()) ThrowDamaged(file, "parents", "a root, whose parent is -1", "none");
  skeleton.root = static_cast<int>(root - arrays.parents.begin());
  for (const Skeleton& builtin : BuiltinSkeletons()) {
    if (builtin.SameJoints(skeleton)) return builtin;
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string& joint = skeleton.joints[static_cast<std::size_t>(j)];
    const std::optional<int> other = skeleton.Find(OtherSide(joint));
    const bool is_pair = other && skeleton.Find(OtherSide(skeleton.joints[static_cast<std::size_t>(*other)])) == j;
    skeleton.mirror.push_back(is_pair ? *other : j);
  }
  if (const std::string problem = skeleton.Problem(); !problem.empty()) {
    ThrowDamaged(file, "joints", "a skeleton", problem);
  }
  return skeleton;
}

LengthUnit UnitIn(const std::string& units, const std::string& file) {
  if (units == "network units") return LengthUnit::kEachItsOwn;
  if (units == ToString(LengthUnit::kMillimetres)) return LengthUnit::kMillimetres;
  if (units == ToString(LengthUnit::kBodyLengths)) return LengthUnit::kBodyLengths;
  ThrowDamaged(file, "units", "\"mm\" or \"network units\"", '"' + units + '"');
}

void RequireSize(const std::string& file, const std::string& name, std::size_t found, std::size_t expected) {
  if (found == expected) return;
  ThrowDamaged(file, name, fmt::format("{} values", expected), fmt::format("{}", found));
}

}  // namespace

bool HasNameOfLiftedFile(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  return extension == ".npz" || extension == ".json";
}

Scene ReadLiftedScene(const std::filesystem::path& path) {
  const std::string file = path.string();
  LiftedArrays arrays = LowerCase(path.extension().string()) == ".npz" ? FromNpz(path) : FromJson(path);
  Skeleton skeleton = SkeletonOf(arrays, file);
  const std::size_t joints = skeleton.joints.size();
  const std::size_t frames = arrays.frames.size();
  RequireSize(file, "pose3d", arrays.positions.size(), 3 * frames * joints);
  RequireSize(file, "confidence", arrays.confidence.size(), frames * joints);
  RequireSize(file, "standard_deviation", arrays.standard_deviation.size(), frames * joints);
  if (frames > INT32_MAX || !std::ranges::is_sorted(arrays.frames) || (frames > 0 && arrays.frames.front() < 0)) {
    ThrowDamaged(file, "frames", "ascending numbers", "others");
  }
  if (!(arrays.fps >= 0.0) || !std::isfinite(arrays.fps)) {
    ThrowDamaged(file, "fps", "a frame rate", fmt::format("{}", arrays.fps));
  }
  if (std::ranges::any_of(arrays.positions, [](float x) { return std::isinf(x); })) {
    ThrowDamaged(file, "pose3d", "coordinates, or NaN where unknown", "an infinite one");
  }
  for (float& confidence : arrays.confidence) {
    if (!(confidence >= 0.0F && confidence <= 1.0F)) {
      ThrowDamaged(file, "confidence", "numbers from 0 to 1", fmt::format("{}", confidence));
    }
  }
  PoseSequence poses(std::move(skeleton), static_cast<int>(frames));
  poses.unit = UnitIn(arrays.units, file);
  poses.fps = arrays.fps;
  poses.positions() = std::move(arrays.positions);
  poses.confidence() = std::move(arrays.confidence);
  poses.standard_deviation() = std::move(arrays.standard_deviation);
  return SceneOfLifted(poses, arrays.frames, path.stem().string());
}

}  // namespace canonpose
