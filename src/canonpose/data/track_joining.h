// Puts together the parts of a person's way through a clip that a long absence tore apart.
#pragma once

#include <vector>

#include "canonpose/data/person_tracking.h"

namespace canonpose {

/// Joins tracks of which one ends before the other begins, where nobody else could be meant: no other track of
/// comparable size and confidence lives at the same time as either part, or the person comes back to the same place at
/// the same size and no other track does so. The most prominent first again.
std::vector<PersonTrack> JoinTracks(const DetectedCamera& camera, std::vector<PersonTrack> tracks);

/// The sightings of tracks that are comparable to tracks[chosen] and live only while it is not seen, before or after:
/// who they are is open. Ascending frames.
std::vector<int> FramesOfPossibleParts(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks,
                                       std::size_t chosen);

}  // namespace canonpose
