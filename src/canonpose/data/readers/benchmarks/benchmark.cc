#include "canonpose/data/readers/benchmarks/benchmark.h"

#include <algorithm>

#include "canonpose/base/error.h"

namespace canonpose {

const std::vector<Benchmark>& Benchmarks() {
  static const std::vector<Benchmark> benchmarks = {};
  return benchmarks;
}

std::string BenchmarkNames() {
  std::string names;
  for (const Benchmark& benchmark : Benchmarks()) names.append(names.empty() ? "" : ", ").append(benchmark.name);
  return names;
}

const Benchmark* FindBenchmark(const std::string& name) {
  const auto found = std::ranges::find_if(Benchmarks(), [&](const Benchmark& one) { return name == one.name; });
  return found == Benchmarks().end() ? nullptr : &*found;
}

void RequireNoOtherOptions(const BenchmarkOptions& options, const std::vector<std::string>& used) {
  const auto refuse = [&](bool given, const std::string& option) {
    if (!given || std::ranges::find(used, option) != used.end()) return;
    ThrowUsage("--{} means nothing for {}: leave it out", option, options.format);
  };
  refuse(!options.calibration.empty(), "calibration");
  refuse(options.image_size[0] != 0, "image-size");
  refuse(!options.cameras.empty(), "cameras");
  refuse(!options.truth.empty(), "truth");
}

}  // namespace canonpose
