// Lifted poses as JSON. As archives they go through the reader of npz.
#include "fuzzing.h"

#include "canonpose/data/lifted_file.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadLiftedScene(canonpose::fuzz::Write("poses.json", bytes)); }
