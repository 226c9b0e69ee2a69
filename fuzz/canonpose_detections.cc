// Human3.6M's detections as published with CanonPose, a pickle.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadBenchmark("canonpose-detections", "detections.pickle", bytes); }
