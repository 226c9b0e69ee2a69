// When feet stand on the floor.
#pragma once

#include <vector>

#include "canonpose/analyse/analysis.h"
#include "canonpose/analyse/segments.h"

namespace canonpose {

/// A foot stands while its heel or its toes (the ankle, where the skeleton has neither) are near the lowest height that
/// they have, and slow; positions are smoothed at 6 Hz before. Near and slow are 0.1 lengths of the leg, and 0.6 of
/// them a second: 9 cm and 0.5 m/s for an adult. Contacts are at least 0.1 s long, and interruptions of less than
/// 0.08 s are none. By first frame. None of a foot whose lowest height is more than half a leg above z = 0, and none
/// where no frame rate or no leg is known.
std::vector<FootContact> FindFootContacts(const PoseSequence& person, const BodyJoints& joints);

}  // namespace canonpose
