// The Acclaim motion capture format: a skeleton (.asf) and clips of it (.amc).
#pragma once

#include <filesystem>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Reads a clip. Its skeleton is the .asf file in the same folder whose name the clip's name begins with
/// ("01_02.amc" -> "01.asf"), or the only .asf file there. The subject is the skeleton file's name.
///
/// The first joint is "root". Every other joint stands at the start of a bone and has the bone's name; the ends of the
/// last bones are "<bone>_end". Bones that start where the root does are joints with a zero offset. A length of 1 is
/// (1 / the file's length unit) inches, which is CMU's convention with its unit of 0.45. Clips have 120 frames per
/// second. A bone's values are in the order of its dof; its rotations are applied in the order of its axis.
///
/// Throws Error(kBadInput).
ArticulatedMotion ReadAcclaim(const std::filesystem::path& amc);

}  // namespace canonpose
