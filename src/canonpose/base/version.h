// The version of the program, as files record it.
#pragma once

namespace canonpose {

/// "0.1.0", from the project's CMakeLists.txt.
inline const char* ProgramVersion() { return CANONPOSE_VERSION; }

}  // namespace canonpose
