#include "canonpose/data/readers/benchmarks/skipose.h"

#include <cmath>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/readers/benchmarks/benchmarks_testing.h"
#include "canonpose/geometry/points.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using namespace canonpose::testing;  // NOLINT: all of it is for these tests
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(SkiPoseTest, ViewsBySubjectSequenceCameraAndFrame) {
  const auto [dataset, log] = Import(Options("skipose", {"skipose"}));
  ASSERT_EQ(dataset.sequences.size(), 3U);
  for (const Sequence& sequence : dataset.sequences) {
    EXPECT_FALSE(sequence.static_cameras);
    ASSERT_EQ(sequence.cameras.size(), 6U);
    for (const char* const camera : {"cam_00", "cam_02"}) {
      const CameraView& view = Find(sequence, camera);
      EXPECT_EQ(view.image_size, (std::array{256, 256}));
      ExpectNear(view.keypoints, File("skipose/expected.npz"), fmt::format("{}|{}|keypoints", sequence.name, camera));
      // The place of the person is found from pixels: half a millimetre at 25 m, with float intrinsics.
      ExpectNear(view.truth.positions(), File("skipose/expected.npz"),
                 fmt::format("{}|{}|truth", sequence.name, camera), 10.0);
      ExpectTruthProjects(view, sequence.frame_count, 0.01);
      EXPECT_EQ(view.calibration.size(), static_cast<std::size_t>(sequence.frame_count));
    }
    EXPECT_EQ(Find(sequence, "cam_02").confidence[3 * 17], 0.0F) << "a view that is not in the file";
    ExpectRightIsRight(dataset, Find(sequence, "cam_01"));
  }
  EXPECT_EQ(Find(dataset, "S1 seq_103").subject, "S1");
  EXPECT_THAT(log, AllOf(HasSubstr("3D is in m, since legs are"), HasSubstr("relative to the person"),
                         HasSubstr("0.00 px of 2D"), HasSubstr("2 of 60 views are not in the file"),
                         HasSubstr("left and right are named correctly")));
  EXPECT_EQ(Import(Options("skipose", {"skipose/test"})).dataset.sequences[0].name, "S3 seq_007");
}

/// The rows of the test file, changed.
class SkiRows {
 public:
  SkiRows() {
    h5::File file = h5::File::OpenForReading(File("skipose/test/labels.h5"));
    for (const std::string& name : file.root().Children()) arrays_[name] = file.root().Read<double>(name);
  }
  std::vector<double>& operator[](const std::string& name) { return arrays_[name].values; }
  void Remove(const std::string& name) { arrays_.erase(name); }
  [[nodiscard]] std::size_t size() { return arrays_["seq"].values.size(); }
  std::string Write(const fs::path& path) {
    h5::File file = h5::File::CreateAt(path);
    for (const auto& [name, array] : arrays_) file.root().Write<double>(name, array.values, array.shape);
    file.Commit();
    return path;
  }

 private:
  std::map<std::string, h5::Array<double>> arrays_;
};

TEST(SkiPoseTest, FrameAndUnitOfPosesAreFound) {
  const TemporaryFolder folder;
  const Dataset original = Import(Options("skipose", {"skipose/test"})).dataset;
  for (const bool is_world : {false, true}) {
    SkiRows rows;
    // Absolute poses, from the places that the importer found.
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Sequence& sequence = original.sequences[0];
      const CameraView& view = Find(sequence, fmt::format("cam_{:02.0f}", rows["cam"][i]));
      const auto frame = static_cast<std::size_t>((rows["frame"][i] - 5) / 3);
      Eigen::Map<Points3d> pose(&rows["3D"][51 * i], 17, 3);
      for (std::size_t k = 0; k < 51; ++k) rows["3D"][51 * i + k] = 0.1 * view.truth.positions()[51 * frame + k];
      Eigen::Map<Eigen::Vector3d> place(&rows["cam_position"][3 * i]);
      place *= 100.0;
      const Eigen::Matrix3d R = view.calibration[frame].camera_from_world_rotation;
      if (is_world) pose = (pose * R).rowwise() + place.transpose();
    }
    const auto [dataset, log] = Import(Options("skipose", {rows.Write(folder / "labels.h5")}));
    EXPECT_THAT(log, AllOf(HasSubstr("3D is in cm"),
                           HasSubstr(is_world ? "in the world's frame, where" : "in the camera's frame, where")));
    const std::vector<float>& expected = original.sequences[0].cameras[0].truth.positions();
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(dataset.sequences[0].cameras[0].truth.positions()[i], expected[i], 0.1);
    }
  }
}

TEST(SkiPoseTest, RotationsAreCheckedBetweenCameras) {
  const TemporaryFolder folder;
  EXPECT_THAT(Import(Options("skipose", {"skipose/test"})).log,
              HasSubstr("differs between cameras by 0.0 mm in the world"));
  SkiRows inverse;
  SkiRows wrong;
  using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (std::size_t i = 0; i < inverse.size(); ++i) {
    Eigen::Map<Rotation>(&inverse["R_cam_2_world"][9 * i]).transposeInPlace();
    const double angle = 2.0 * wrong["cam"][i];
    Eigen::Map<Rotation> rotation(&wrong["R_cam_2_world"][9 * i]);
    rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * rotation;
  }
  const auto [dataset, log] = Import(Options("skipose", {inverse.Write(folder / "labels.h5")}));
  EXPECT_THAT(log, HasSubstr("R_cam_2_world is inverted"));
  const Dataset original = Import(Options("skipose", {"skipose/test"})).dataset;
  const Camera& camera = dataset.sequences[0].cameras[1].calibration[0];
  const Camera& truth = original.sequences[0].cameras[1].calibration[0];
  EXPECT_TRUE(camera.camera_from_world_rotation.isApprox(truth.camera_from_world_rotation, 1e-6));
  EXPECT_THAT(Import(Options("skipose", {wrong.Write(folder / "labels.h5")})).log,
              HasSubstr("do not trust a triangulation"));
}

TEST(SkiPoseTest, LegsWithTheOtherSidesNameAreRenamed) {
  const TemporaryFolder folder;
  SkiRows rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 3; k < 12; ++k) std::swap(rows["3D"][51 * i + k], rows["3D"][51 * i + k + 9]);
    for (std::size_t k = 2; k < 8; ++k) std::swap(rows["2D"][34 * i + k], rows["2D"][34 * i + k + 6]);
  }
  const auto [dataset, log] = Import(Options("skipose", {rows.Write(folder / "labels.h5")}));
  EXPECT_THAT(log, HasSubstr("the left and right legs have each other's names"));
  ExpectNear(Find(dataset.sequences[0], "cam_00").keypoints, File("skipose/expected.npz"),
             "S3 seq_007|cam_00|keypoints");
}

TEST(SkiPoseTest, NaNIsAMissingJoint) {
  const TemporaryFolder folder;
  const Dataset original = Import(Options("skipose", {"skipose/test"})).dataset;
  SkiRows rows;
  rows["3D"][3 * 5 + 1] = NAN;  // row 0, joint 5
  rows["2D"][2 * 7] = NAN;      // row 0, joint 7
  const auto name = fmt::format("cam_{:02.0f}", rows["cam"][0]);
  const auto frame = static_cast<int>((rows["frame"][0] - 5) / 3);
  const auto [dataset, log] = Import(Options("skipose", {rows.Write(folder / "labels.h5")}));
  EXPECT_THAT(log, HasSubstr("0.00 px of 2D"));
  const CameraView& view = Find(dataset.sequences[0], name);
  const CameraView& before = Find(original.sequences[0], name);
  for (int joint = 0; joint < 17; ++joint) {
    EXPECT_EQ(view.truth.IsKnown(frame, joint), joint != 5) << joint;
    EXPECT_EQ(view.confidence[static_cast<std::size_t>(17 * frame + joint)], joint == 7 ? 0.0F : 1.0F) << joint;
    if (joint == 5) continue;
    EXPECT_LT((view.truth.PoseAt(frame).row(joint) - before.truth.PoseAt(frame).row(joint)).norm(), 10.0F) << joint;
  }
}

TEST(SkiPoseTest, InvalidFilesAreRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](auto change) {
    SkiRows rows;
    change(rows);
    return Refusal(Options("skipose", {rows.Write(folder / "labels.h5")}));
  };
  EXPECT_THAT(refusal([](SkiRows& r) { r.Remove("cam_position"); }),
              HasSubstr("/cam_position: expected an array, found nothing"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["2D"][70] = 130.0; }),
              HasSubstr("/2D: expected fractions of the image, 0 to 1, found 130"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["3D"][60] = INFINITY; }),
              HasSubstr("/3D, row 1, joint 9: expected a coordinate, found inf"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["cam_position"][3] = NAN; }), HasSubstr("/cam_position, row 1"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["frame"][3] = 2.5; }),
              HasSubstr("/frame: expected whole numbers from 0 on, found 2.5"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["R_cam_2_world"][9] = 3.0; }),
              HasSubstr("/R_cam_2_world, row 1: expected a rotation"));
  EXPECT_THAT(refusal([](SkiRows& r) { r["cam_intrinsic"][8] = 2.0; }), HasSubstr("/cam_intrinsic, row 0"));
  EXPECT_THAT(refusal([](SkiRows& r) {
                for (double& value : r["3D"]) value *= 20;
              }),
              HasSubstr("in mm, cm or m"));
  EXPECT_THAT(refusal([](SkiRows& r) {
                for (const char* const name : {"cam", "frame", "subj", "seq"}) r[name][1] = r[name][0];
              }),
              HasSubstr("each view once"));
  EXPECT_THAT(Refusal(Options("skipose", {"h36m"})), HasSubstr("labels.h5"));
  EXPECT_THAT(Refusal(Options("skipose", {"3dhp_test/TS1/annot_data.mat"})),
              HasSubstr("/seq: expected an array, found nothing"));
}

}  // namespace
}  // namespace canonpose
