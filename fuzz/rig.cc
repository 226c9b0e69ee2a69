// The cameras of a simulation as JSON.
#include "fuzzing.h"

#include "canonpose/simulate/rig_parts.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadRigFile(canonpose::fuzz::Write("rig.json", bytes)); }
