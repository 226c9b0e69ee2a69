// The scenes in a file, whatever kind of file it is.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// Reads a scene file, the scenes of a solved dataset (ScenesOfSolved()), or the poses of a file that `lift` wrote
/// (.npz, .json). Throws Error(kBadInput).
std::vector<Scene> ReadScenes(const std::filesystem::path& path);

}  // namespace canonpose
