// The cameras of a simulation as JSON.
#include "canonpose/simulate/rig_parts.h"
#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadRigFile(canonpose::fuzz::Write("rig.json", bytes)); }
