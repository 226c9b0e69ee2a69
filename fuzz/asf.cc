// The skeleton of an Acclaim motion.
#include "fuzzing.h"

#include "canonpose/motion/readers/acclaim_skeleton.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadAcclaimSkeleton(canonpose::fuzz::Write("skeleton.asf", bytes)); }
