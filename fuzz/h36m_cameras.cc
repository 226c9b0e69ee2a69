// Human3.6M's cameras as JSON, with poses that are as they should be.
#include "benchmarks.h"

CANONPOSE_FUZZ_TARGET(bytes) {
  canonpose::BenchmarkOptions options;
  options.format = "h36m";
  options.paths = {CANONPOSE_TESTDATA "/benchmarks/wrong/h36m_2d_good.npz",
                   CANONPOSE_TESTDATA "/benchmarks/wrong/h36m_3d_good.npz"};
  options.calibration = canonpose::fuzz::Write("cameras.json", bytes);
  canonpose::ImportBenchmark(options);
}
