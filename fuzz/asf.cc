// The skeleton of an Acclaim motion.
#include "canonpose/motion/readers/acclaim_skeleton.h"
#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadAcclaimSkeleton(canonpose::fuzz::Write("skeleton.asf", bytes)); }
