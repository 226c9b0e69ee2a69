#include "canonpose/evaluate/reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/two_cameras_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TwoCameras;

TEST(ReferenceTest, IsTriangulatedWithoutTruth) {
  const Dataset dataset = TwoCameras();
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_TRUE(reference.triangulated());
  const SequencePoses expected = TriangulateSequence(dataset.sequences[0], dataset.skeleton);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(reference.sequences()[0].poses_in_camera[c].positions(), expected.poses_in_camera[c].positions());
  }
  EXPECT_EQ(reference.reprojection_errors_px().size(), 6U) << "three joints in two views";
  ReferenceSummary summary;
  summary.Add(reference);
  EXPECT_LT(summary.Kind().reprojection_px->median_px, 0.01);
  EXPECT_EQ(summary.Kind().description, "triangulated from the calibration");
}

TEST(ReferenceTest, TruthTakesPrecedenceOverCalibration) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[0].truth = TruthPoses(dataset.skeleton, std::vector<float>(9, 1.0F), "a");
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_FALSE(reference.triangulated());
  EXPECT_EQ(reference.sequences()[0].poses_in_camera[0].positions().front(), 1.0F);
  EXPECT_TRUE(reference.sequences()[0].poses_in_camera[1].empty());
}

TEST(ReferenceTest, NeitherIsAnError) {
  Dataset dataset = TwoCameras();
  for (CameraView& view : dataset.sequences[0].cameras) view.calibration.clear();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReferencePoses(dataset, "a.h5"); }),
              AllOf(HasSubstr("a.h5"), HasSubstr("`calibration`")));
}

}  // namespace
}  // namespace canonpose
