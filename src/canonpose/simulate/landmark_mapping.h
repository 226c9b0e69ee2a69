// Which joint of a motion is which landmark, by the names that joints go by.
#pragma once

#include "canonpose/simulate/motion.h"

namespace canonpose {

/// The stature of a body whose hips, knees and ankles are found by name, from the length of its legs (mm, or the unit
/// of the offsets); 0 where they are not found.
double StatureByLegs(const std::vector<MotionJoint>& joints);

}  // namespace canonpose
