// MPI-INF-3DHP's training set, a MATLAB file.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadBenchmark("3dhp-train", "annot.mat", bytes); }
