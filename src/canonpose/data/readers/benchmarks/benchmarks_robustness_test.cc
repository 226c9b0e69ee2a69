// Damaged files of benchmarks: cut anywhere, with bytes exchanged, a reader either reads them or says what is wrong.
#include <array>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {
namespace {

using testing::TemporaryFolder;
using testing::TestData;

struct Victim {
  const char* format;
  const char* file;
};

constexpr std::array<Victim, 8> kVictims{{{"h36m", "wrong/h36m_2d_good.npz"},
                                          {"canonpose-detections", "wrong/detections_17_joints.pickle"},
                                          {"canonpose-detections", "canonpose/detections_p5.pickle"},
                                          {"3dhp-train", "3dhp_train/S2/Seq2/annot.mat"},
                                          {"3dhp-train", "wrong/train_metres.mat"},
                                          {"3dhp-test", "3dhp_test/TS1/annot_data.mat"},
                                          {"3dhp-test", "3dhp_test/TS5/annot_data.mat"},
                                          {"skipose", "skipose/test/labels.h5"}}};

/// Whether the reader takes the bytes. Anything but an Error of bad input ends the test.
bool Reads(const Victim& victim, const std::string& bytes) {
  const TemporaryFolder folder;
  BenchmarkOptions options;
  options.format = victim.format;
  options.paths = {folder / "file"};
  if (options.format == "3dhp-test") options.image_size = {2048, 2048};
  std::ofstream(folder / "file", std::ios::binary) << bytes;
  bool reads = true;
  try {
    ImportBenchmark(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    reads = false;
  }
  return reads;
}

TEST(DamagedBenchmarks, CutAnywhere) {
  for (const Victim& victim : kVictims) {
    const std::string bytes = ReadFile(TestData("benchmarks") / victim.file);
    for (std::size_t i = 0; i < 60; ++i) {
      const std::size_t length = (bytes.size() - 1) * i / 59;
      EXPECT_FALSE(Reads(victim, bytes.substr(0, length))) << victim.file << " cut at " << length;
    }
  }
}

TEST(DamagedBenchmarks, BytesReplaced) {
  Rng rng(31);
  for (const Victim& victim : kVictims) {
    const std::string whole = ReadFile(TestData("benchmarks") / victim.file);
    for (int i = 0; i < 120; ++i) {
      std::string bytes = whole;
      // Half of them in the first part, where headers are.
      const std::size_t range = i % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 4096);
      for (std::size_t n = 0; n <= rng.Index(4); ++n) bytes[rng.Index(range)] = static_cast<char>(rng.Index(256));
      Reads(victim, bytes);
    }
  }
}

}  // namespace
}  // namespace canonpose
