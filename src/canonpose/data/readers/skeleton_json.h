// A user's own skeleton, as JSON: for animals, and for detectors whose layout the program does not know.
#pragma once

#include <filesystem>
#include <string>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// Whether the text that names a layout is the path of such a file rather than the name of a built-in layout.
bool IsSkeletonFile(const std::string& layout);

/// {joints: [names], parents: [index or name of the parent, -1 or null for the root], mirror?: [index or name of the
/// left-right partner], root?: index or name}, as in the dataset. Without `mirror` the partners follow from the names.
/// The skeleton has the file's name, without folder and extension. Throws Error(kBadInput).
Skeleton ReadSkeletonJson(const std::filesystem::path& path);

}  // namespace canonpose
