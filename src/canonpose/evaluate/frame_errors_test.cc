#include "canonpose/evaluate/frame_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

FrameErrors Sample() {
  PoseErrors errors;
  errors.outcome = PoseOutcome::kEvaluated;
  errors.scaled_mm = {0.0, 10.00004, NAN};
  errors.aligned_mm = {1.0, 2.0, NAN};
  FrameErrors frame_errors;
  frame_errors.Add({"S9 \"one\", two", "cam1", 64, "Walking"}, errors, false);
  errors.aligned_mm[0] = 500.25;
  frame_errors.Add({"S9", "cam2", 128}, errors, true);
  return frame_errors;
}

TEST(FrameErrorsTest, CsvHasOneRowPerPose) {
  const TemporaryFolder folder;
  Sample().Write(folder / "errors.csv", {"Hip", "A", "B"});
  EXPECT_EQ(ReadFile(folder / "errors.csv"),
            "sequence,camera,frame,action,n_mpjpe_mm,p_mpjpe_mm,largest_aligned_mm,mirrored\n"
            "\"S9 \"\"one\"\", two\",cam1,64,Walking,5.0000,1.5000,2.0000,0\n"
            "S9,cam2,128,,5.0000,251.1250,500.2500,1\n");
}

TEST(FrameErrorsTest, NpzAlsoHasTheJoints) {
  const TemporaryFolder folder;
  Sample().Write(folder / "errors.npz", {"Hip", "A", "B"});
  const NpzReader reader(folder / "errors.npz");
  EXPECT_THAT(reader.ReadStrings("joints"), ElementsAre("Hip", "A", "B"));
  EXPECT_THAT(reader.ReadStrings("camera"), ElementsAre("cam1", "cam2"));
  std::vector<std::size_t> shape;
  const std::vector<float> scaled = reader.ReadFloats("n_error_mm", &shape);
  EXPECT_THAT(shape, ElementsAre(2, 3));
  EXPECT_FLOAT_EQ(scaled[4], 10.00004F);
  EXPECT_TRUE(std::isnan(scaled[5]));
  EXPECT_THAT(reader.ReadFloats("frame", &shape), ElementsAre(64.0F, 128.0F));
  EXPECT_THAT(reader.ReadFloats("mirrored", &shape), ElementsAre(0.0F, 1.0F));
  EXPECT_THAT(reader.ReadFloats("largest_aligned_mm", &shape), ElementsAre(2.0F, 500.25F));
}

TEST(FrameErrorsTest, OtherFormatsAreRefused) {
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { FrameErrors::RequireFormat("errors.txt"); }),
              HasSubstr(".csv or .npz"));
  FrameErrors::RequireFormat("errors.csv");
}

}  // namespace
}  // namespace canonpose
