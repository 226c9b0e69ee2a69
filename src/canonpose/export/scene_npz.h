// npz: a scene as NumPy arrays.
#pragma once

#include <filesystem>
#include <string>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// Arrays of P people and C cameras:
///
///   positions (P, T, J, 3), confidence (P, T, J), standard_deviation (P, T, J); NaN where unknown
///   time (T) seconds, NaN where unknown; fps, where it is known
///   people (P names), joints (J names), parents (J numbers, -1 for the root)
///   cameras (C names), image_size (C, 2); K (C, 3, 3), R (C, 3, 3), t (C, 3) and distortion (C, 5), each with a second
///   dimension T where a camera moves; NaN for cameras that are unknown
///   unit, unit_from, up, up_from, processing, name: texts, as in scene_json.h; "" for nothing
///
/// Throws Error(kInvalidArgument) where people have different joints, and Error(kBadInput) where the file cannot be
/// written.
void WriteSceneNpz(const std::filesystem::path& path, const Scene& scene, const FileSpace& space,
                   const std::string& processing = "");

}  // namespace canonpose
