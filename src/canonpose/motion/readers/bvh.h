// The BVH motion capture format.
#pragma once

#include <filesystem>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Reads a BVH file. Its y axis points up, unless rest pose or motion show that another one does (StandUpright()). The
/// subject is the name of the file's folder.
///
/// `unit_mm` is the length of the file's unit. 0 means: guess it from the stature, and log the guess. The body is then
/// taken to be between 1.2 and 2.3 m tall in mm, cm, dm, inches, CMU's units or m; its stature is measured by its legs
/// where their joints are known by name, otherwise by the extent of the rest pose.
///
/// End sites become joints "<parent>_end", except those with a zero offset, which are dropped. The root's positions
/// replace its offset. Where a joint below it moves instead and has nearly all others below it (hips under a still
/// "Armature"), that joint is the root, and the motion of those above it is part of its own. Positions of other joints
/// must equal their offset to within 1.7 mm, 0.1 % of a stature.
///
/// Throws Error(kBadInput).
ArticulatedMotion ReadBvh(const std::filesystem::path& path, double unit_mm = 0.0);

}  // namespace canonpose
