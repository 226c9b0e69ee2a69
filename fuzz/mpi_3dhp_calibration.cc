// MPI-INF-3DHP's camera.calibration, text, with poses that are as they should be.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::BenchmarkOptions options;
  options.format = "3dhp-train";
  options.paths = {CANONPOSE_TESTDATA "/benchmarks/3dhp_train/S2/Seq2/annot.mat"};
  options.calibration = canonpose::fuzz::Write("camera.calibration", bytes);
  canonpose::ImportBenchmark(options);
}
