// Reads what `lift` wrote for programs: .npz and .json (export/lift_output.h).
#pragma once

#include <filesystem>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// Whether the name says that it is such a file.
bool HasNameOfLiftedFile(const std::filesystem::path& path);

/// The poses of such a file as SceneOfLifted() has them; the scene has the name of the file. Throws Error(kBadInput).
Scene ReadLiftedScene(const std::filesystem::path& path);

}  // namespace canonpose
