// CSV: the people of a scene for spreadsheets and data frames.
#pragma once

#include <string>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// One row per frame: frame, time in seconds where it is known, x, y and z of every joint with the unit in the header,
/// "LKnee_x [m]", "LKnee_confidence" of every joint, its standard deviation, "LKnee_sd [m]", and in the last column
/// `up` the axis that points up, or "unknown". What is missing is an empty cell. Of several people, each column begins
/// with the person's name, "anna:LKnee_x [m]". What was done to the positions, if anything, is in a further column
/// `processing`.
std::string SceneCsv(const Scene& scene, const FileSpace& space, const std::string& processing = "");

}  // namespace canonpose
