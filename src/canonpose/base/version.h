// The version of the program, as files record it.
#pragma once

namespace canonpose {

/// "0.1.0", from the project's CMakeLists.txt.
const char* ProgramVersion();

}  // namespace canonpose
