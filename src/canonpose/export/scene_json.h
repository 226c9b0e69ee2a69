// JSON: a scene for programs that read nothing else.
#pragma once

#include <string>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// One object:
///
///   format "canonpose-scene-json", version 1, name
///   unit "m", "mm", "body lengths" or "each pose its own"; unit_from; up "z", "y" or "unknown"; up_from
///   processing, what was done to the positions (null: nothing)
///   fps (null where unknown), time (T seconds, null where unknown)
///   people [{name, joints, parents, positions (T, J, 3), confidence (T, J), standard_deviation (T, J)}]
///   cameras [{name, image_size, used, why_not_used, time_offset_seconds, K, R, t, distortion}], where the last four
///   are null for a camera that is unknown, and lists of T of them for one that moves
///
/// null stands where a value is missing.
std::string SceneJson(const Scene& scene, const FileSpace& space, const std::string& processing = "");

}  // namespace canonpose
