// GLB (binary glTF 2.0): moving people and cameras for web viewers, Blender and game engines.
#pragma once

#include <filesystem>

#include "canonpose/export/scene_motion.h"

namespace canonpose {

/// Writes a scene (MakeSceneMotion()) with y up, in metres:
///
/// - for each person a node with their name and below it the hierarchy, with a rest pose in T; a skin of its joints,
/// and a
///   mesh of simple shapes that it moves: the left in blue, the right in vermilion, which the colour-blind tell apart;
/// - for each camera a node with a camera, whose field of view is that of its K, and a frustum of lines. A lens with an
///   off-centre axis or distortion cannot be said; K and distortion are in the node's extras. Nodes of cameras that
///   move are animated; where the field of view changes, it is the median one;
/// - where it is known, the floor;
/// - one animation of everything, with the times of the frames.
///
/// The scene's extras say what up and scale are known from, those of a person's node how well the hierarchy fits.
/// Throws Error(kBadInput).
void WriteSceneGlb(const std::filesystem::path& path, const Scene& scene, const MotionExportOptions& options);

}  // namespace canonpose
