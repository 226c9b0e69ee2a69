#include "canonpose/pipeline/lifter_start.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/pipeline/pipeline_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::ShareStarted;
using testing::SmallCapture;

TEST(Bootstrap, TakesTheStarterForPeople) {
  const Dataset dataset = SmallCapture("studio");
  const StartPoses start = Bootstrap(dataset, "data.h5", {});
  ASSERT_EQ(start.sequences.size(), 1U);
  ASSERT_EQ(start.sequences[0].size(), dataset.sequences[0].cameras.size());
  EXPECT_EQ(start.sequences[0][0].frame_count(), dataset.sequences[0].frame_count);
  EXPECT_TRUE(start.sequences[0][0].skeleton().SameJoints(dataset.skeleton));
  EXPECT_EQ(start.sequences[0][0].unit, LengthUnit::kEachItsOwn);
  EXPECT_EQ(start.sequences[0][0].coordinate_frame.kind, CoordinateFrame::Kind::kRoot);
  EXPECT_GT(ShareStarted(start), 0.9);
  // Poses are centred on the root.
  EXPECT_NEAR(start.sequences[0][0].PoseAt(0)(dataset.skeleton.root, 0), 0.0F, 1e-6);
}

TEST(Bootstrap, TrainingTheLifterToStartFromCanBeStopped) {
  BootstrapOptions options;
  options.kind = "method";
  int polls = 0;
  Callbacks callbacks;
  callbacks.stop = [&] { return ++polls > 3; };
  const CallbackScope scope(callbacks);
  const Dataset dataset = SmallCapture("studio");
  EXPECT_THAT(ErrorOf(ErrorKind::kStopped, [&] { Bootstrap(dataset, "data.h5", options); }), HasSubstr("stopped"));
}

}  // namespace
}  // namespace canonpose
