#include "canonpose/data/readers/benchmarks/h36m.h"

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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

BenchmarkOptions H36m() {
  BenchmarkOptions options = Options("h36m", {"h36m/data_2d_h36m_gt.npz", "h36m/data_3d_h36m.npz"});
  options.calibration = File("h36m/cameras.json");
  return options;
}

TEST(H36mTest, KeypointsAndTruthOfEveryCamera) {
  const auto [dataset, log] = Import(H36m());
  EXPECT_EQ(dataset.skeleton.name, "h36m-17");
  EXPECT_EQ(dataset.sequences.size(), 6U);
  for (const char* const subject : {"S1", "S9"}) {
    const Sequence& sequence = Find(dataset, fmt::format("{} Walking 1", subject));
    EXPECT_EQ(sequence.subject, subject);
    EXPECT_EQ(sequence.capture, subject);
    EXPECT_TRUE(sequence.static_cameras);
    EXPECT_EQ(sequence.fps, 50.0);
    EXPECT_THAT(sequence.actions, ElementsAre("Walking"));
    EXPECT_EQ(sequence.frame_count, 12) << "2D has three more frames";
    ASSERT_EQ(sequence.cameras.size(), 4U);
    for (const CameraView& view : sequence.cameras) {
      const std::string key = fmt::format("{}|{}", sequence.name, view.name);
      ExpectNear(view.keypoints, File("h36m/expected.npz"), key + "|keypoints");
      ExpectNear(view.truth.positions(), File("h36m/expected.npz"), key + "|truth");
      ExpectTruthProjects(view, sequence.frame_count, kTolerance);
      EXPECT_EQ(view.confidence, std::vector<float>(12 * 17, 1.0F));
    }
    ExpectRightIsRight(dataset, sequence.cameras.front());
  }
  const Sequence& dog = Find(dataset, "S9 WalkDog 1");
  EXPECT_TRUE(dog.cameras[0].truth.empty());
  EXPECT_THAT(dog.actions, ElementsAre("WalkDog"));
  EXPECT_EQ(Find(dog, "54138969").image_size, (std::array{1000, 1002}));
  EXPECT_EQ(Find(dog, "55011271").image_size, (std::array{1000, 1000}));
  EXPECT_THAT(log, AllOf(HasSubstr("3D poses are in m: legs are 8"), HasSubstr("all are 1"), HasSubstr("(12 of 15)"),
                         HasSubstr("no truth, of S9 WalkDog 1"), HasSubstr("is 0.00 px")));
}

TEST(H36mTest, TruthNeedsCameras) {
  BenchmarkOptions options = H36m();
  options.calibration.clear();
  std::swap(options.paths[0], options.paths[1]);
  const auto [dataset, log] = Import(options);
  EXPECT_FALSE(dataset.HasTruth() || dataset.HasCalibration());
  EXPECT_THAT(log, HasSubstr("h36m_cameras_extrinsic_params"));
  EXPECT_EQ(dataset.sequences[0].cameras[0].name, "54138969");

  const auto [flat, flat_log] = Import(Options("h36m", {"h36m/data_2d_h36m_gt.npz"}));
  EXPECT_EQ(flat.sequences.size(), 6U);
  EXPECT_EQ(Find(flat, "S1 Walking 1").frame_count, 15);
  EXPECT_THAT(flat_log, Not(HasSubstr("warning")));
}

TEST(H36mTest, OtherSkeletonsCamerasAndForms) {
  BenchmarkOptions options = H36m();
  options.skeleton = "canonpose-16";
  options.cameras = {"60457274", "55011271"};
  const Dataset dataset = Import(options).dataset;
  const Dataset whole = Import(H36m()).dataset;
  EXPECT_EQ(dataset.skeleton.joints[6], "root");
  const Sequence& sequence = Find(dataset, "S1 Walking 1");
  ASSERT_EQ(sequence.cameras.size(), 2U);
  const CameraView& view = Find(sequence, "60457274");
  const CameraView& other = Find(Find(whole, "S1 Walking 1"), "60457274");
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    EXPECT_EQ(view.truth.PoseAt(0)(6, axis), other.truth.PoseAt(0)(0, axis)) << "the root";
  options.cameras = {"1"};
  EXPECT_THAT(Refusal(options), AllOf(HasSubstr("camera 1, as `cameras` says"), HasSubstr("54138969, 55011271")));

  const Dataset good = Import(Options("h36m", {"wrong/h36m_2d_good.npz"})).dataset;
  const Dataset array = Import(Options("h36m", {"wrong/h36m_2d_one_array.npz"})).dataset;
  EXPECT_EQ(good.Fingerprint(), array.Fingerprint());
  const Dataset confident = Import(Options("h36m", {"wrong/h36m_2d_confidences.npz"})).dataset;
  EXPECT_EQ(confident.sequences[0].cameras[1].confidence[5], 0.25F);
  EXPECT_EQ(confident.sequences[0].cameras[1].keypoints, good.sequences[0].cameras[1].keypoints);
}

TEST(H36mTest, UnitAndSidesAreReported) {
  const auto with_3d = [](const char* file) {
    BenchmarkOptions options = Options("h36m", {"wrong/h36m_2d_good.npz", std::string("wrong/") + file});
    options.calibration = File("h36m/cameras.json");
    return options;
  };
  const auto [metres, metres_log] = Import(with_3d("h36m_3d_good.npz"));
  const auto [mm, mm_log] = Import(with_3d("h36m_3d_mm.npz"));
  EXPECT_THAT(mm_log, HasSubstr("3D poses are in mm"));
  for (std::size_t i = 0; i < 17 * 3; ++i) {
    EXPECT_NEAR(mm.sequences[0].cameras[2].truth.positions()[i], metres.sequences[0].cameras[2].truth.positions()[i],
                kTolerance);
  }
  EXPECT_THAT(Refusal(with_3d("h36m_3d_unit.npz")),
              AllOf(HasSubstr("legs of 300 to 1300 mm"), HasSubstr("e+05 units")));
  EXPECT_THAT(Import(with_3d("h36m_3d_swapped.npz")).log,
              HasSubstr("warning: S9 WalkDog 1: left and right look swapped, or the knees bend backwards"));
  EXPECT_THAT(metres_log, Not(HasSubstr("swapped")));
}

TEST(H36mTest, NaNIsAMissingJoint) {
  const Dataset dataset = Import(Options("h36m", {"wrong/h36m_2d_nan.npz"})).dataset;
  const CameraView& view = dataset.sequences[0].cameras[2];
  const std::size_t joint = 3 * 17 + 5;
  EXPECT_TRUE(std::isnan(view.keypoints[2 * joint]) && std::isnan(view.keypoints[2 * joint + 1]));
  EXPECT_EQ(view.confidence[joint], 0.0F);
  EXPECT_EQ(view.confidence[joint + 1], 1.0F);
}

TEST(H36mTest, NaNInTheTruthIsAMissingJoint) {
  BenchmarkOptions options = Options("h36m", {"wrong/h36m_2d_good.npz", "wrong/h36m_3d_nan.npz"});
  options.calibration = File("h36m/cameras.json");
  const Dataset dataset = Import(options).dataset;
  for (const CameraView& view : dataset.sequences[0].cameras) {
    for (int t = 0; t < view.truth.frame_count(); ++t) {
      for (int joint = 0; joint < 17; ++joint) {
        EXPECT_EQ(view.truth.IsKnown(t, joint), !(t == 2 && joint == 6)) << t << " " << joint;
        EXPECT_EQ(view.truth.PoseAt(t).row(joint).array().isFinite().any(), view.truth.IsKnown(t, joint));
      }
    }
  }
}

TEST(H36mTest, InvalidFilesAreRefused) {
  const auto refusal = [](const std::string& file) { return Refusal(Options("h36m", {"wrong/" + file})); };
  EXPECT_THAT(refusal("h36m_2d_16_joints.npz"),
              AllOf(HasSubstr("[\"S9\"][\"WalkDog 1\"][0]"), HasSubstr("(8, 16, 2)")));
  EXPECT_THAT(refusal("h36m_2d_3_cameras.npz"), HasSubstr("expected 4 cameras, found 3"));
  EXPECT_THAT(refusal("h36m_2d_fractions.npz"), HasSubstr("fractions of the image"));
  EXPECT_THAT(refusal("h36m_2d_layout.npz"), HasSubstr("humaneva"));
  EXPECT_THAT(refusal("h36m_3d_good.npz"), HasSubstr("only 3D poses"));
  EXPECT_THAT(refusal("../h36m/expected.npz"), HasSubstr("positions_2d in one file"));
  EXPECT_THAT(refusal("../h36m/cameras.json"), HasSubstr(".npz archive"));
  EXPECT_THAT(refusal("nowhere.npz"), HasSubstr("expected a file, found nothing"));
  EXPECT_THAT(Refusal(Options("h36m", {"wrong/h36m_2d_good.npz", "wrong/h36m_3d_17_joints.npz"})),
              HasSubstr("(8, 17, 3)"));
  EXPECT_THAT(Refusal(Options("h36m", {"wrong/h36m_2d_short.npz", "wrong/h36m_3d_good.npz"})),
              HasSubstr("at least as many frames as the 3D poses have, 8, found 5"));
}

}  // namespace
}  // namespace canonpose
