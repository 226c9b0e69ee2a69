// MOT and STO: joint angles over time as text, as OpenSim reads and writes them.
#pragma once

#include <string>
#include <vector>

#include "canonpose/analyse/analysis.h"

namespace canonpose {

/// A table under a header of that name: the time in seconds and every angle in degrees. Angles that are unknown in all
/// frames are left out; in single frames they are NaN, as OpenSim itself writes and reads it. A line of the header
/// has `processing`, what was done to the positions before, where there is something. Throws std::logic_error where the
/// frame rate is unknown, or an angle has another number of frames than the person, and
/// Error(kInvalidArgument) where no angle is known.
std::string AngleTable(const std::vector<TimeSeries>& angles, const PoseSequence& person, const std::string& name,
                       const std::string& processing = "");

}  // namespace canonpose
