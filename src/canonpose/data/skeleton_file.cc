#include "canonpose/data/skeleton_file.h"

namespace canonpose {

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
  for (const std::int64_t parent : group.GetInts("parents")) skeleton.parents.push_back(static_cast<int>(parent));
  skeleton.root = static_cast<int>(group.GetInt("root"));
  for (const std::int64_t partner : group.GetInts("mirror")) skeleton.mirror.push_back(static_cast<int>(partner));
  if (const std::string problem = skeleton.Problem(); !problem.empty()) {
    group.Fail("", "a skeleton", problem, "correct the attributes of this group");
  }
  return skeleton;
}

}  // namespace canonpose
