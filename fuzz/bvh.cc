// A BVH motion.
#include "canonpose/motion/readers/bvh.h"

#include "fuzzing.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::ReadBvh(canonpose::fuzz::Write("clip.bvh", bytes)); }
