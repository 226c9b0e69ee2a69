// How tall a person is by the lengths of the bones, however he or she stands.
#pragma once

#include <optional>
#include <string>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

struct StatureEstimate {
  double stature = 0.0;              ///< from the sole to the top of the head, in the unit of the poses
  double uncertainty_percent = 0.0;  ///< how much people of one height differ in these bones: a standard deviation
  std::string bones;                 ///< that it is from: "the lengths of legs and trunk"
};

/// From the medians over time of the segments' lengths: legs and trunk, or what is known of them, otherwise the arms.
/// They add up to a share of the stature (skeleton/anthropometry.h). The head is not used: what is called so is its top
/// with one detector and the middle of the eyes with another. Nothing where the skeleton is not a person's, or no
/// segment is known.
std::optional<StatureEstimate> EstimateStature(const PoseSequence& person);

}  // namespace canonpose
