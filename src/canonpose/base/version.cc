#include "canonpose/base/version.h"

namespace canonpose {

const char* ProgramVersion() { return CANONPOSE_VERSION; }

}  // namespace canonpose
