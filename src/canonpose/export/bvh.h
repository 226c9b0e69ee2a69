// BVH: motion for Blender, game engines and other animation software.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/export/scene_motion.h"
#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Writes a motion with y up, lengths in centimetres, and rotations as Zrotation Xrotation Yrotation in degrees; the
/// root also has positions. In every frame, the angles are those nearest to the previous frame's, so that they can be
/// interpolated.
///
/// A leaf "<parent>_end" that is its parent's only child is written as the parent's End Site, which cannot rotate. Any
/// other leaf is a joint with channels and an End Site with a zero offset. ReadBvh() returns the same joints, in the
/// order of a depth-first traversal, and the same positions to 0.01 mm. Names must not contain braces or line ends.
/// Throws Error(kBadInput) where the file cannot be written.
void WriteBvh(const std::filesystem::path& path, const ArticulatedMotion& motion);

/// Writes each person of a scene (MakeSceneMotion()). A file of this format has one hierarchy: one person gets `path`,
/// each of several a file beside it with their name, "walk-anna.bvh" for walk.bvh. All have the same axes, origin and
/// frames; the frame time is the mean one, and LogWarning() says where frames are unevenly spaced. Returns the files.
/// Throws Error(kBadInput).
std::vector<std::filesystem::path> WriteSceneBvh(const std::filesystem::path& path, const Scene& scene,
                                                 const MotionExportOptions& options);

}  // namespace canonpose
