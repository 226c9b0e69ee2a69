// The last lines of `run`: what came of it, where it is, and what to do next.
#pragma once

#include <string>
#include <vector>

#include "canonpose/pipeline/run_recording.h"

namespace canonpose {

/// For somebody who uses the program for the first time. `program` is how it was called, and `folder` the output;
/// `heights` are the values of --height.
std::string ClosingLines(const RunReport& report, const std::string& program, const std::filesystem::path& folder,
                         const std::vector<std::string>& heights);

}  // namespace canonpose
