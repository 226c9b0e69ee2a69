// A user's own skeleton.
#include "canonpose/data/readers/skeleton_json.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadSkeletonJson(canonpose::fuzz::Write("skeleton.json", bytes)); }
