// The field's benchmarks as datasets: which there are, and which options each supports.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

struct BenchmarkOptions {
  std::string format;  ///< "h36m", ...
  std::vector<std::filesystem::path> paths;
  std::filesystem::path calibration;  ///< empty: none
  std::string skeleton;  ///< the skeleton to map to, "native" for the benchmark's own; empty: its usual one
  std::string layout;    ///< the order of the joints, where a benchmark's files differ in it; empty: the usual one
  std::string truth;     ///< "annot3" or "univ_annot3"; empty: the one that the field compares with
  std::vector<std::string> cameras;     ///< by name, in the order of the file; empty: all
  std::array<int, 2> image_size{0, 0};  ///< 0: the benchmark's
  double fps = 0.0;                     ///< 0: the benchmark's, or unknown

  /// Throws Error(kInvalidArgument), also for options that the benchmark does not support.
  void Validate() const;
};

struct BenchmarkFormat {
  std::string_view name;                  ///< as on the command line
  std::vector<std::string_view> options;  ///< the fields that it supports besides `skeleton` and `cameras`
  Dataset (*import)(const BenchmarkOptions& options);
};

const std::vector<BenchmarkFormat>& BenchmarkFormats();

/// A benchmark by name, ignoring case; null if there is none.
const BenchmarkFormat* FindBenchmarkFormat(std::string_view name);

/// "h36m, canonpose-detections, ..."
std::string BenchmarkFormatNames();

/// Imports a benchmark's files; logs what it found and how it recognised it. Throws Error(kBadInput).
Dataset ImportBenchmark(const BenchmarkOptions& options);

}  // namespace canonpose
