#include "canonpose/export/person_names.h"

#include <algorithm>

#include <fmt/format.h>

namespace canonpose {

std::vector<std::string> PersonNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const PoseSequence& person : scene.people) {
    const std::string wanted = person.name.empty() ? fmt::format("person{}", names.size() + 1) : person.name;
    std::string name = wanted;
    for (int number = 2; std::ranges::count(names, name) > 0; ++number) name = fmt::format("{}_{}", wanted, number);
    names.push_back(name);
  }
  return names;
}

std::vector<std::string> PersonPrefixes(const Scene& scene) {
  if (scene.people.size() == 1) return {""};
  std::vector<std::string> prefixes = PersonNames(scene);
  for (std::string& prefix : prefixes) prefix += ':';
  return prefixes;
}

}  // namespace canonpose
