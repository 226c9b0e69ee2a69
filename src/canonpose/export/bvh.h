// BVH: motion for Blender, game engines and other tools of animation.
#pragma once

#include <filesystem>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Writes a motion with y up, lengths in centimetres, rotations as Zrotation Xrotation Yrotation in degrees; the root
/// has positions, too. Frame by frame the angles are those nearest to the frame before, so that they can be
/// interpolated.
///
/// A leaf "<parent>_end" that is its parent's only child is written as the parent's End Site; it cannot turn by itself.
/// Any other leaf is a joint with channels and an End Site at no distance. ReadBvh() gives back the same joints in the
/// order of a walk through the tree, children in their order, and the same positions to 0.01 mm. Names that hold a
/// brace or the end of a line cannot be written. Throws Error(kBadInput) where the file cannot be written.
void WriteBvh(const std::filesystem::path& path, const ArticulatedMotion& motion);

}  // namespace canonpose
