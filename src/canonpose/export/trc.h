// TRC: positions of points over time as text, the format of OpenSim's markers.
#pragma once

#include <string>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// The contents of a file of that name. A row per frame: its number from 1 on, its time in seconds, and x, y and z of
/// every joint; a missing joint is three empty cells. Where the unit is unknown, its field says "unknown", and a
/// comment in the first line says what the unit is; likewise where up is unknown, and where `processing`
/// says what was done to the positions. Throws std::logic_error where the frame rate is unknown.
std::string TrcText(const PoseSequence& person, const FileSpace& space, const std::string& file_name,
                    const std::string& processing = "");

}  // namespace canonpose
