#include "canonpose/data/readers/benchmarks/benchmark.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/readers/benchmarks/canonpose_detections.h"
#include "canonpose/data/readers/benchmarks/h36m.h"
#include "canonpose/data/readers/benchmarks/mpi_3dhp_test_set.h"
#include "canonpose/data/readers/benchmarks/mpi_3dhp_train_set.h"
#include "canonpose/data/readers/benchmarks/skipose.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

const std::vector<BenchmarkFormat>& BenchmarkFormats() {
  static const std::vector<BenchmarkFormat> formats = {
      {"h36m", {"calibration"}, ImportH36m},
      {"canonpose-detections", {"image_size", "layout", "fps"}, ImportCanonPoseDetections},
      {"3dhp-train", {"calibration", "truth", "fps"}, ImportMpi3dhpTrain},
      {"3dhp-test", {"image_size", "truth", "fps"}, ImportMpi3dhpTest},
      {"skipose", {"fps"}, ImportSkiPose}};
  return formats;
}

const BenchmarkFormat* FindBenchmarkFormat(std::string_view name) {
  const auto found = std::ranges::find_if(BenchmarkFormats(),
                                          [&](const BenchmarkFormat& format) { return SameName(format.name, name); });
  return found == BenchmarkFormats().end() ? nullptr : &*found;
}

std::string BenchmarkFormatNames() {
  std::vector<std::string_view> names;
  for (const BenchmarkFormat& format : BenchmarkFormats()) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void BenchmarkOptions::Validate() const {
  const BenchmarkFormat* const benchmark = FindBenchmarkFormat(format);
  if (benchmark == nullptr) {
    ThrowInvalidArgument("there is no benchmark \"{}\"; the benchmarks are {}", format, BenchmarkFormatNames());
  }
  if (paths.empty()) ThrowInvalidArgument("give the benchmark's file");
  for (const auto& [option, is_given] :
       {std::pair("calibration", !calibration.empty()), std::pair("layout", !layout.empty()),
        std::pair("truth", !truth.empty()), std::pair("image_size", image_size[0] > 0), std::pair("fps", fps != 0.0)}) {
    const bool is_understood =
        std::find(benchmark->options.begin(), benchmark->options.end(), option) != benchmark->options.end();
    if (is_given && !is_understood) ThrowInvalidArgument("{1} does not support `{0}`", option, benchmark->name);
  }
  if (!truth.empty() && truth != "annot3" && truth != "univ_annot3") {
    ThrowInvalidArgument("`truth` is annot3 or univ_annot3, not \"{}\"", truth);
  }
  if (!std::isfinite(fps) || fps < 0.0) ThrowInvalidArgument("`fps` must be above 0, not {}", fps);
  if (!skeleton.empty() && skeleton != "native" && FindSkeleton(skeleton) == nullptr) {
    ThrowInvalidArgument("there is no skeleton \"{}\"; the skeletons are {} and native", skeleton,
                         BuiltinSkeletonNames());
  }
}

Dataset ImportBenchmark(const BenchmarkOptions& options) {
  options.Validate();
  return FindBenchmarkFormat(options.format)->import(options);
}

}  // namespace canonpose
