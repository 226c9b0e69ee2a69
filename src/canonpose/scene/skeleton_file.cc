#include "canonpose/scene/skeleton_file.h"

#include <limits>

#include <fmt/format.h>

namespace canonpose {
namespace {

/// Indices of joints; whether such joints exist is checked by Skeleton::Problem().
int JointNumber(const h5::Group& group, const std::string& attribute, std::int64_t value) {
  if (value < -1 || value > std::numeric_limits<int>::max()) {
    group.Fail("attribute " + attribute, "indices of joints", fmt::format("{}", value),
               "correct the attributes of this group");
  }
  return static_cast<int>(value);
}

std::vector<int> JointNumbers(const h5::Group& group, const std::string& attribute) {
  std::vector<int> numbers;
  for (const std::int64_t value : group.GetInts(attribute)) numbers.push_back(JointNumber(group, attribute, value));
  return numbers;
}

}  // namespace

void WriteSkeleton(h5::Group& group, const Skeleton& skeleton) {
  if (!skeleton.name.empty()) group.SetString("name", skeleton.name);
  group.SetStrings("joints", skeleton.joints);
  group.SetInts("parents", {skeleton.parents.begin(), skeleton.parents.end()});
  group.SetInt("root", skeleton.root);
  group.SetInts("mirror", {skeleton.mirror.begin(), skeleton.mirror.end()});
}

Skeleton ReadSkeleton(const h5::Group& group) {
  Skeleton skeleton;
  if (group.HasAttribute("name")) skeleton.name = group.GetString("name");
  skeleton.joints = group.GetStrings("joints");
  skeleton.parents = JointNumbers(group, "parents");
  skeleton.root = JointNumber(group, "root", group.GetInt("root"));
  skeleton.mirror = JointNumbers(group, "mirror");
  if (const std::string problem = skeleton.Problem(); !problem.empty()) {
    group.Fail("", "a skeleton", problem, "correct the attributes of this group");
  }
  return skeleton;
}

}  // namespace canonpose
