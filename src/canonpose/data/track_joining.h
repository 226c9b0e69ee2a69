// Joins the tracks of one person that a long absence has separated.
#pragma once

#include <vector>

#include "canonpose/data/person_tracking.h"

namespace canonpose {

/// Joins tracks of which one ends before the other begins, where nobody else could be meant: no other track of
/// comparable size and confidence exists at the same time as either part, or the person returns to the same place at
/// the same size and no other track does. The result is again sorted by prominence.
std::vector<PersonTrack> JoinTracks(const DetectedCamera& camera, std::vector<PersonTrack> tracks);

/// The sightings of tracks that are comparable to tracks[chosen] and exist only while it is not seen, before or after,
/// so that they may be the same person. Ascending frames.
std::vector<int> FramesOfPossibleParts(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks,
                                       std::size_t chosen);

}  // namespace canonpose
