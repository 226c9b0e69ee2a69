#include "canonpose/data/readers/benchmarks/benchmark.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/data/readers/benchmarks/benchmarks_testing.h"

namespace canonpose {
namespace {

using namespace canonpose::testing;  // NOLINT: all of it is for these tests
using ::testing::HasSubstr;

TEST(BenchmarkTest, UnsupportedOptionsAreRefused) {
  const auto refusal = [](const std::string& format, auto change) {
    BenchmarkOptions options = Options(format, {"x"});
    change(options);
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); });
  };
  EXPECT_THAT(refusal("h36m", [](BenchmarkOptions& o) { o.truth = "annot3"; }),
              HasSubstr("h36m does not support `truth`"));
  EXPECT_THAT(refusal("h36m", [](BenchmarkOptions& o) { o.fps = 25; }), HasSubstr("`fps`"));
  EXPECT_THAT(refusal("skipose", [](BenchmarkOptions& o) { o.calibration = "x"; }), HasSubstr("`calibration`"));
  EXPECT_THAT(refusal("3dhp-train", [](BenchmarkOptions& o) { o.image_size = {1, 1}; }), HasSubstr("`image_size`"));
  EXPECT_THAT(refusal("3dhp-test", [](BenchmarkOptions& o) { o.layout = "x"; }), HasSubstr("`layout`"));
  EXPECT_THAT(refusal("3dhp-test", [](BenchmarkOptions& o) { o.truth = "annot2"; }),
              HasSubstr("annot3 or univ_annot3"));
  EXPECT_THAT(refusal("3dhp-test", [](BenchmarkOptions& o) { o.skeleton = "x"; }), HasSubstr("no skeleton \"x\""));
  EXPECT_THAT(refusal("3dhp-test", [](BenchmarkOptions& o) { o.paths.clear(); }),
              HasSubstr("give the benchmark's file"));
  EXPECT_THAT(refusal("nonsense", [](BenchmarkOptions&) {}), HasSubstr("h36m, canonpose-detections, 3dhp-train"));
  EXPECT_EQ(FindBenchmarkFormat("H36M"), FindBenchmarkFormat("h36m"));
}

}  // namespace
}  // namespace canonpose
