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

/// The scenes of a solved dataset: one for each sequence, but one of several people where sequences were filmed
/// together (Sequence::scene), under that name. People of such a scene who were not solved are left out. Throws
/// Error(kBadInput) as above, and where what was filmed together does not have the same frames.
std::vector<Scene> ScenesOfSolved(const Dataset& dataset, const std::string& file);

/// The sequences of the people of a scene that ScenesOfSolved() made, in their order.
std::vector<const Sequence*> SequencesOf(const Dataset& dataset, const Scene& scene);

}  // namespace canonpose
