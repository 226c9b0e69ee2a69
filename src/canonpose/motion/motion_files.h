// Finds and reads motion capture files of any format.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Reads an .amc or .bvh file, by its extension (readers/acclaim.h, readers/bvh.h). Throws Error(kBadInput).
ArticulatedMotion ReadMotion(const std::filesystem::path& path);

/// All clips at the paths, sorted, each once: files as they are, and every .amc and .bvh file below a folder. Throws
/// Error(kBadInput) where a path does not exist or contains no clip.
std::vector<std::filesystem::path> FindMotionFiles(const std::vector<std::filesystem::path>& paths);

}  // namespace canonpose
