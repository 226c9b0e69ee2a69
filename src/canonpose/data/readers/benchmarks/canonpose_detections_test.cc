#include "canonpose/data/readers/benchmarks/canonpose_detections.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/data/readers/benchmarks/benchmarks_testing.h"

namespace canonpose {
namespace {

using namespace canonpose::testing;  // NOLINT: all of it is for these tests
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(CanonPoseDetectionsTest, PlanarRowsBySubject) {
  for (const char* const protocol : {"p2", "p4", "p5"}) {
    SCOPED_TRACE(protocol);
    const auto [dataset, log] =
        Import(Options("canonpose-detections", {fmt::format("canonpose/detections_{}.pickle", protocol)}));
    EXPECT_EQ(dataset.skeleton.name, "canonpose-16");
    ASSERT_EQ(dataset.sequences.size(), 2U);
    EXPECT_EQ(dataset.sequences[0].name, "S5") << "the file's order";
    EXPECT_EQ(dataset.sequences[0].frame_count, 16);
    EXPECT_EQ(dataset.sequences[1].subject, "S1");
    for (const Sequence& sequence : dataset.sequences) {
      ASSERT_EQ(sequence.cameras.size(), 4U);
      for (const CameraView& view : sequence.cameras) {
        ExpectNear(view.keypoints, File("canonpose/expected.npz"),
                   fmt::format("{}|{}|keypoints", sequence.name, view.name));
        EXPECT_EQ(view.image_size, (std::array{1000, 1002}));
      }
    }
    EXPECT_THAT(log, AllOf(HasSubstr("which anatomy confirms"), HasSubstr("1000x1002")));
    std::vector<std::size_t> shape;
    const std::vector<float> confidence =
        NpzReader(File("canonpose/expected.npz")).ReadFloats("confidence|54138969", &shape);
    const double scale = std::string(protocol) == "p4" ? dataset.source.confidence_scale / 1.25 : 1.0;
    EXPECT_NEAR(Find(dataset.sequences[0], "54138969").confidence[20], confidence[20] / scale, 1e-6);
    EXPECT_EQ(std::string(protocol) == "p4", log.find("confidences reach 1.2") != std::string::npos);
  }
}

TEST(CanonPoseDetectionsTest, AnotherOrderIsDetected) {
  BenchmarkOptions options = Options("canonpose-detections", {"canonpose/detections_mpii_order.pickle"});
  EXPECT_THAT(Import(options).log, HasSubstr("look like those of mpii-16 rather than canonpose-16"));
  options.layout = "mpii-16";
  options.image_size = {640, 480};
  const auto [dataset, log] = Import(options);
  EXPECT_THAT(log, AllOf(HasSubstr("which anatomy confirms"), Not(HasSubstr("image size"))));
  ExpectNear(Find(dataset.sequences[1], "58860488").keypoints, File("canonpose/expected.npz"), "S1|58860488|keypoints");
  EXPECT_EQ(dataset.sequences[0].cameras[0].image_size, (std::array{640, 480}));
  options.layout = "coco-17";
  EXPECT_THAT(Refusal(options, ErrorKind::kInvalidArgument), HasSubstr("mpii-16"));
  options.layout.clear();
  options.skeleton = "h36m-17";
  EXPECT_EQ(Import(options).dataset.skeleton.joints[7], "Spine");
}

TEST(CanonPoseDetectionsTest, NaNIsAMissingJoint) {
  const Dataset dataset = Import(Options("canonpose-detections", {"wrong/detections_nan.pickle"})).dataset;
  int missing = 0;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) {
      for (std::size_t i = 0; i < view.confidence.size(); ++i) {
        EXPECT_EQ(std::isnan(view.keypoints[2 * i]), view.confidence[i] == 0.0F);
        missing += std::isnan(view.keypoints[2 * i]) && i % 16 == 1 ? 1 : 0;
      }
    }
  }
  EXPECT_GE(missing, 1);
}

TEST(CanonPoseDetectionsTest, InvalidFilesAreRefused) {
  const auto refusal = [](const std::string& file) { return Refusal(Options("canonpose-detections", {file})); };
  EXPECT_THAT(refusal("wrong/detections_no_subjects.pickle"), HasSubstr("a member \"subjects\", found poses_2d_pred"));
  EXPECT_THAT(refusal("wrong/detections_17_joints.pickle"), HasSubstr("found shape (6, 34)"));
  EXPECT_THAT(refusal("wrong/detections_rows.pickle"), HasSubstr("an array (7, 32)"));
  EXPECT_THAT(refusal("wrong/detections_negative.pickle"), HasSubstr("found -0.5"));
  EXPECT_THAT(refusal("wrong/detections_camera.pickle"),
              HasSubstr("[\"confidences\"]: expected a member \"54138969\", found x"));
  EXPECT_THAT(refusal("wrong/detections_objects.pickle"), HasSubstr("an array of numbers"));
  EXPECT_THAT(refusal("pickles/os_system_p2.pickle"), HasSubstr("posix.system"));
  EXPECT_THAT(refusal("h36m/cameras.json"), HasSubstr("a Python pickle"));
}

}  // namespace
}  // namespace canonpose
