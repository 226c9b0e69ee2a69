#include "canonpose/data/readers/skeleton_json.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/names.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/skeleton/joint_names.h"

namespace canonpose {
namespace {

constexpr std::size_t kMostJoints = 512;
constexpr const char* kSkeletonAdvice =
    "write {\"joints\": [names], \"parents\": [-1, 0, ...], \"mirror\": [left-right partners], \"root\": 0}, as "
    "docs/dataset.md says";

/// The index of a joint, which the file gives as a number or by name; -1 for null.
int JointIndex(const JsonValue& value, const Skeleton& skeleton) {
  if (value.IsNull()) return -1;
  if (value.json().is_string()) {
    const std::optional<int> joint = skeleton.Find(value.String());
    if (!joint) value.Fail("the name of a joint", fmt::format("the joints are {}", fmt::join(skeleton.joints, ", ")));
    return *joint;
  }
  const std::int64_t index = value.Integer();
  if (index < -1 || index >= skeleton.joint_count()) {
    value.Fail(fmt::format("-1 or the index of one of {} joints", skeleton.joint_count()), "count them from 0");
  }
  return static_cast<int>(index);
}

std::vector<int> JointIndices(const JsonValue& list, const Skeleton& skeleton) {
  if (list.ArraySize() != skeleton.joints.size()) {
    list.Fail(fmt::format("{} values, one per joint", skeleton.joints.size()), "", fmt::format("{}", list.ArraySize()));
  }
  std::vector<int> indices;
  for (std::size_t j = 0; j < list.ArraySize(); ++j) indices.push_back(JointIndex(list.At(j), skeleton));
  return indices;
}

}  // namespace

bool IsSkeletonFile(const std::string& layout) {
  return LowerCase(std::filesystem::path(layout).extension().string()) == ".json";
}

Skeleton ReadSkeletonJson(const std::filesystem::path& path) {
  const JsonValue root = JsonValue::Load(path);
  if (!root.Has("joints") || !root.Has("parents")) {
    root.Fail("a skeleton with joints and parents", kSkeletonAdvice, root.DescribeStructure());
  }
  const JsonValue joints = root["joints"];
  if (joints.ArraySize() > kMostJoints) joints.Fail(fmt::format("at most {} joints", kMostJoints));
  Skeleton skeleton;
  skeleton.name = path.stem().string();
  for (std::size_t j = 0; j < joints.ArraySize(); ++j) skeleton.joints.push_back(joints.At(j).String());
  skeleton.parents = JointIndices(root["parents"], skeleton);
  const auto first = std::find(skeleton.parents.begin(), skeleton.parents.end(), -1);
  if (const std::optional<JsonValue> value = root.Find("root")) {
    skeleton.root = JointIndex(*value, skeleton);
  } else {
    skeleton.root = first == skeleton.parents.end() ? -1 : static_cast<int>(first - skeleton.parents.begin());
  }
  const std::optional<JsonValue> mirror = root.Find("mirror");
  skeleton.mirror = mirror ? JointIndices(*mirror, skeleton) : SidePartners(skeleton.joints);
  if (const std::string problem = skeleton.Problem(); !problem.empty()) {
    root.Fail("a skeleton", kSkeletonAdvice, "one where " + problem);
  }
  return skeleton;
}

}  // namespace canonpose
