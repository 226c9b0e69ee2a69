// Ski-PosePTZ, HDF5.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) { canonpose::fuzz::ReadBenchmark("skipose", "labels.h5", bytes); }
