// The field's benchmarks as datasets: which there are, and what of the command line each understands.
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
  std::filesystem::path calibration;    ///< empty: none
  std::string skeleton;                 ///< what to map to, "native" for the benchmark's own; empty: its usual one
  std::string layout;                   ///< the joints' order, where a benchmark's files differ in it; empty: the usual
  std::string truth;                    ///< "annot3" or "univ_annot3"; empty: what the field compares with
  std::vector<std::string> cameras;     ///< by name, in the order of the file; empty: all
  std::array<int, 2> image_size{0, 0};  ///< 0: the benchmark's
  double fps = 0.0;                     ///< 0: the benchmark's, or unknown

  /// Throws Error(kInvalidArgument), also for options that have no meaning for the benchmark.
  void Validate() const;
};

struct BenchmarkFormat {
  std::string_view name;                  ///< as on the command line
  std::vector<std::string_view> options;  ///< the options that it understands besides --skeleton and --cameras
  Dataset (*import)(const BenchmarkOptions& options);
};

const std::vector<BenchmarkFormat>& BenchmarkFormats();

/// By name, ignoring case; null where there is none.
const BenchmarkFormat* FindBenchmarkFormat(std::string_view name);

/// "h36m, canonpose-detections, ..."
std::string BenchmarkFormatNames();

/// The dataset of a benchmark's files; says in the log what it found and how it knew. Throws Error(kBadInput).
Dataset ImportBenchmark(const BenchmarkOptions& options);

}  // namespace canonpose
