#include "canonpose/train/checkpoint.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// A checkpoint whose best restart has a best restart, and so on.
Checkpoint Nested(int depth) {
  Checkpoint checkpoint;
  checkpoint.info.skeleton = *FindSkeleton("coco-17");
  checkpoint.info.width = 16;
  checkpoint.parameters["weight"] = {{1.0F, 2.0F}, {2}};
  if (depth > 0) checkpoint.restarts.best = std::make_shared<const Checkpoint>(Nested(depth - 1));
  return checkpoint;
}

TEST(Checkpoint, RefusesABestRestartInABestRestart) {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  WriteCheckpoint(path, Nested(1));
  const Checkpoint read = ReadCheckpoint(path);
  ASSERT_NE(read.restarts.best, nullptr);
  EXPECT_EQ(read.restarts.best->parameters.at("weight").values, (std::vector<float>{1.0F, 2.0F}));
  // As where a damaged group holds itself, and reading it would have no end.
  WriteCheckpoint(path, Nested(2));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadCheckpoint(path); }),
              HasSubstr("/best_restart/best_restart: expected no further one"));
}

}  // namespace
}  // namespace canonpose
