// What `solve` found, as a scene.
#pragma once

#include "canonpose/data/dataset.h"
#include "canonpose/scene/scene.h"

namespace canonpose {

/// The person and the cameras of a solved sequence in the world of its solved cameras, in the unit of
/// CameraView::solved, with what is known of that world (Sequence::solved_world). A joint's confidence is the largest
/// that any camera has of it.
/// Throws Error(kBadInput) naming `file` where the sequence has not been solved.
Scene SceneOfSolved(const Dataset& dataset, const Sequence& sequence, const std::string& file);

}  // namespace canonpose
