// C3D: positions of points over time, the binary format of motion labs (https://www.c3d.org).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// The bytes of a file with floats in Intel's order and a point for every joint of every person, named "LKnee", or
/// "anna:LKnee" where there are several people.
///
///   - A missing joint is (0, 0, 0) with a residual of -1.
///   - The residual of others is the standard deviation, in steps of |POINT:SCALE|; 0 where it is unknown.
///   - The camera mask has a bit for each of the first seven cameras that saw the joint, from `seen_by`
///   (ExportOptions).
///   - Names longer than 127 bytes are shortened; of more than 255 points, the rest is in POINT:LABELS2, LABELS3, ...
///   - More than 65535 frames are counted by TRIAL:ACTUAL_END_FIELD, and POINT:FRAMES is -1.
///   - POINT:X_SCREEN and Y_SCREEN say which way is up. Where up or the unit is unknown, CANONPOSE:UP and
///     POINT:UNITS say "unknown"; CANONPOSE:UNIT has more.
///   - CANONPOSE:PROCESSING says what was done to the positions.
///
/// Throws std::logic_error where the frame rate is unknown, and Error(kInvalidArgument) for more than 65535 points.
std::string C3dBytes(const Scene& scene, const FileSpace& space, const std::vector<std::vector<std::uint8_t>>& seen_by,
                     const std::string& processing = "");

}  // namespace canonpose
