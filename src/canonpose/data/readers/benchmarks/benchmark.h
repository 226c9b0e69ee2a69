// The field's benchmarks as datasets: one reader a benchmark, one way in.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

struct BenchmarkOptions {
  std::string format;                        ///< a name of Benchmarks()
  std::vector<std::filesystem::path> paths;  ///< files of the benchmark, or folders that hold them
  std::filesystem::path calibration;         ///< cameras where the benchmark keeps them elsewhere; empty: none
  std::array<int, 2> image_size{0, 0};       ///< width, height in pixels; 0: what is known of the benchmark
  std::vector<std::string> cameras;          ///< those to keep; empty: the benchmark's usual ones
  std::string truth;                         ///< which of several truths, "annot3"; empty: the benchmark's usual one
  std::string skeleton = "h36m-17";          ///< "native": the benchmark's own joints
};

struct BenchmarkData {
  Dataset dataset;
  std::vector<std::string>
      findings;  ///< what was found: subjects, clips, frames, units and how they were told; a line each
  std::vector<std::string> warnings;  ///< where the data contradict their layout, or something is left out; a line each
};

struct Benchmark {
  const char* name;
  const char* help;  ///< what its paths are
  BenchmarkData (*read)(
      const BenchmarkOptions&);  ///< throws Error(kBadInput), Error(kUsage) for options it has no use for
};

const std::vector<Benchmark>& Benchmarks();

/// "h36m, ...", for messages and help.
std::string BenchmarkNames();

/// Null where it is no benchmark.
const Benchmark* FindBenchmark(const std::string& name);

/// Throws Error(kUsage) where an option that is not in `used` ("calibration", "image-size", "cameras", "truth") was
/// given.
void RequireNoOtherOptions(const BenchmarkOptions& options, const std::vector<std::string>& used);

// The readers, a file each.
BenchmarkData ReadHuman36m(const BenchmarkOptions& options);
BenchmarkData ReadCanonposeDetections(const BenchmarkOptions& options);
BenchmarkData ReadInfTrain(const BenchmarkOptions& options);
BenchmarkData ReadInfTest(const BenchmarkOptions& options);
BenchmarkData ReadSkiPose(const BenchmarkOptions& options);

}  // namespace canonpose
