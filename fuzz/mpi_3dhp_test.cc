// MPI-INF-3DHP's test set, HDF5.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadBenchmark("3dhp-test", "annot_data.mat", bytes); }
