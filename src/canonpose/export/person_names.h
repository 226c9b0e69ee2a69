// Names of people where a file keeps several.
#pragma once

#include <string>
#include <vector>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// Names of the people, no two alike: numbered from 1 where they have none, or the same.
std::vector<std::string> PersonNames(const Scene& scene);

/// What the names of a person's joints begin with: nothing for the only one, otherwise "NAME:".
std::vector<std::string> PersonPrefixes(const Scene& scene);

}  // namespace canonpose
