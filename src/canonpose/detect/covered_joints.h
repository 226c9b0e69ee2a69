// Joints that another person hides, where the network guesses.
#pragma once

#include <vector>

#include "canonpose/detect/tracker.h"

namespace canonpose {

/// A covered joint keeps this share of its score.
inline constexpr float kCoveredShare = 0.25F;

/// Lowers the scores of joints that lie on the trunk of a person in front. Of two people the one whose feet are lower
/// in the image is in front; where feet are not seen or level, the one whose joints on the other's trunk have higher
/// scores.
void MarkCoveredJoints(std::vector<TrackedPose>& people);

}  // namespace canonpose
