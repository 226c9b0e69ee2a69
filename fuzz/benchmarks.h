// What the targets of the benchmarks share.
#pragma once

#include <string>
#include <string_view>

#include "fuzzing.h"

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose::fuzz {

/// Imports a benchmark that consists of one file of this name.
inline void ReadBenchmark(const std::string& format, const std::string& name, std::string_view bytes) {
  BenchmarkOptions options;
  options.format = format;
  options.paths = {Write(name, bytes)};
  if (format == "3dhp-test") options.image_size = {2048, 2048};
  ImportBenchmark(options);
}

}  // namespace canonpose::fuzz
