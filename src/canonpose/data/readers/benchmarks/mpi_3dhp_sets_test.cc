// MPI-INF-3DHP, training and test set.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/readers/benchmarks/benchmarks_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using namespace canonpose::testing;  // NOLINT: all of it is for these tests
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kTrain1 = "3dhp_train/S1/Seq1/annot.mat";
constexpr const char* kTrain2 = "3dhp_train/S2/Seq2/annot.mat";

TEST(Mpi3dhpTrainTest, SeventeenJointsOfTwentyEight) {
  const auto [dataset, log] = Import(Options("3dhp-train", {kTrain1, kTrain2}));
  ASSERT_EQ(dataset.sequences.size(), 2U);
  for (const char* const name : {"S1 Seq1", "S2 Seq2"}) {
    const Sequence& sequence = Find(dataset, name);
    EXPECT_EQ(sequence.capture, name);
    EXPECT_EQ(sequence.truth_kind, "annot3");
    ASSERT_EQ(sequence.cameras.size(), 14U);
    for (const char* const camera : {"0", "7"}) {
      ExpectNear(Find(sequence, camera).keypoints, File("3dhp_train/expected.npz"),
                 fmt::format("{}|{}|keypoints", name, camera));
      ExpectNear(Find(sequence, camera).truth.positions(), File("3dhp_train/expected.npz"),
                 fmt::format("{}|{}|truth", name, camera));
    }
    EXPECT_EQ(sequence.cameras[3].image_size, (std::array{2048, 2048}));
  }
  EXPECT_EQ(dataset.sequences[1].subject, "S2");
  ExpectRightIsRight(dataset, dataset.sequences[0].cameras[4]);
  EXPECT_THAT(
      log, AllOf(HasSubstr("truth is annot3"), HasSubstr("14 cameras per sequence"), HasSubstr("in mm: legs are 8")));
}

TEST(Mpi3dhpTrainTest, CalibrationTruthAndCamerasByChoice) {
  BenchmarkOptions options = Options("3dhp-train", {kTrain1});
  options.calibration = File("3dhp_train/S1/Seq1/camera.calibration");
  options.cameras = {"0", "2", "4", "7", "8"};
  const auto [dataset, log] = Import(options);
  ASSERT_EQ(dataset.sequences[0].cameras.size(), 5U);
  for (const CameraView& view : dataset.sequences[0].cameras) ExpectTruthProjects(view, 7, 0.01);
  EXPECT_THAT(log, HasSubstr("is 0.00 px from annot2"));

  options.truth = "univ_annot3";
  options.skeleton = "h36m-17";
  const Dataset universal = Import(options).dataset;
  EXPECT_EQ(universal.sequences[0].truth_kind, "univ_annot3");
  ExpectNear(Find(universal.sequences[0], "7").truth.positions(), File("3dhp_train/expected.npz"), "S1 Seq1|7|univ");

  options.truth.clear();
  options.skeleton = "native";
  const Dataset native = Import(options).dataset;
  EXPECT_EQ(native.skeleton.joints[0], "head_top");
  EXPECT_EQ(native.skeleton.joint_count(), 17);
  EXPECT_EQ(native.skeleton.joints[static_cast<std::size_t>(native.skeleton.root)], "pelvis");
  const CameraView& view = native.sequences[0].cameras[0];
  const CameraView& in_h36m = dataset.sequences[0].cameras[0];
  EXPECT_EQ(view.keypoints[2 * 14], in_h36m.keypoints[0]) << "the pelvis";
  EXPECT_EQ(view.keypoints[2 * 4], in_h36m.keypoints[2 * 16]) << "the right wrist";
  EXPECT_EQ(view.keypoints[2 * 1], in_h36m.keypoints[2 * 8]) << "the neck is Human3.6M's thorax";

  options.paths.push_back(File(kTrain2));
  EXPECT_THAT(Refusal(options, ErrorKind::kInvalidArgument), HasSubstr("one sequence"));
  EXPECT_THAT(Refusal(Options("3dhp-train", {kTrain1, kTrain1})), HasSubstr("S1 Seq1 twice"));
}

TEST(Mpi3dhpTrainTest, InvalidFilesAreRefused) {
  const auto refusal = [](const std::string& file) { return Refusal(Options("3dhp-train", {file})); };
  EXPECT_THAT(refusal("wrong/train_13_cameras.mat"), HasSubstr("a cell array of 14 matrices, found 13 cells"));
  EXPECT_THAT(refusal("wrong/train_27_joints.mat"), AllOf(HasSubstr("annot2{1}"), HasSubstr("found (1, 54)")));
  EXPECT_THAT(refusal("wrong/train_frames.mat"), HasSubstr("1 frames as in annot2, found 2"));
  EXPECT_THAT(refusal("wrong/train_no_annot3.mat"), HasSubstr("annot3: expected a variable of that name"));
  EXPECT_THAT(refusal("wrong/train_matrix.mat"), HasSubstr("no cell array"));
  EXPECT_THAT(refusal("3dhp_test/TS1/annot_data.mat"), HasSubstr("import 3dhp-test"));
  EXPECT_THAT(refusal("h36m/cameras.json"), HasSubstr("another format"));
  EXPECT_THAT(refusal("3dhp_test"), HasSubstr("files annot.mat in this folder, found none"));
  EXPECT_THAT(Import(Options("3dhp-train", {"wrong/train_metres.mat"})).log,
              HasSubstr("annot3 is in m, by the length of legs"));
  BenchmarkOptions options = Options("3dhp-train", {kTrain1});
  options.calibration = File("h36m/cameras.json");
  EXPECT_THAT(Refusal(options),
              AllOf(HasSubstr("cameras.json: line 2: expected \"name\""), HasSubstr("seven lines per camera")));
}

TEST(Mpi3dhpTrainTest, NaNIsAMissingJoint) {
  BenchmarkOptions options = Options("3dhp-train", {"wrong/train_nan.mat"});
  options.skeleton = "native";
  const Dataset dataset = Import(options).dataset;
  const int spine = dataset.skeleton.Find("spine").value();
  const std::vector<CameraView>& cameras = dataset.sequences[0].cameras;
  for (int joint = 0; joint < dataset.skeleton.joint_count(); ++joint) {
    EXPECT_EQ(cameras[3].truth.IsKnown(0, joint), joint != spine) << joint;
    EXPECT_TRUE(cameras[2].truth.IsKnown(0, joint)) << joint;
  }
  EXPECT_EQ(cameras[3].confidence[static_cast<std::size_t>(spine)], 1.0F) << "its 2D joint is there";
}

TEST(Mpi3dhpTrainTest, FoldersMeanTheirFiles) {
  const Dataset files = Import(Options("3dhp-train", {kTrain1, kTrain2})).dataset;
  const Dataset folder = Import(Options("3dhp-train", {"3dhp_train"})).dataset;
  EXPECT_EQ(folder.Fingerprint(), files.Fingerprint());
  EXPECT_EQ(Import(Options("3dhp-test", {"3dhp_test"})).dataset.sequences.size(), 2U);
  BenchmarkOptions options = Options("3dhp-train", {"3dhp_train"});
  options.calibration = File("3dhp_train/S1/Seq1/camera.calibration");
  EXPECT_THAT(Refusal(options, ErrorKind::kInvalidArgument), HasSubstr("one sequence"));
  options.paths = {File("3dhp_train/S1")};
  ExpectTruthProjects(Import(options).dataset.sequences[0].cameras[0], 7, 0.01);
}

constexpr const char* kTest1 = "3dhp_test/TS1/annot_data.mat";
constexpr const char* kTest5 = "3dhp_test/TS5/annot_data.mat";

TEST(Mpi3dhpTestTest, OneCameraAndValidFrames) {
  const auto [dataset, log] = Import(Options("3dhp-test", {kTest1, kTest5}));
  ASSERT_EQ(dataset.sequences.size(), 2U);
  for (const Sequence& sequence : dataset.sequences) {
    ASSERT_EQ(sequence.cameras.size(), 1U);
    const CameraView& view = sequence.cameras[0];
    EXPECT_EQ(sequence.truth_kind, "univ_annot3");
    EXPECT_EQ(sequence.frame_count, 12);
    ExpectNear(view.keypoints, File("3dhp_test/expected.npz"), sequence.name + "|keypoints");
    ExpectNear(view.truth.positions(), File("3dhp_test/expected.npz"), sequence.name + "|univ_annot3");
    EXPECT_TRUE(std::isnan(view.truth.positions()[2 * 17 * 3])) << "a frame that is not valid";
    EXPECT_EQ(sequence.actions.size(), 7U);
    EXPECT_THAT(sequence.action, ElementsAre(0, 0, 0, 0, 3, 3, 3, 3, 5, 5, 5, 5));
  }
  EXPECT_EQ(dataset.sequences[0].name, "TS1");
  EXPECT_EQ(dataset.sequences[0].cameras[0].image_size, (std::array{2048, 2048}));
  EXPECT_EQ(dataset.sequences[1].cameras[0].image_size, (std::array{1920, 1080}));
  EXPECT_THAT(
      log, AllOf(HasSubstr("10 of 12 frames are valid"), HasSubstr("axes first"), HasSubstr("truth is univ_annot3")));
  ExpectRightIsRight(dataset, dataset.sequences[1].cameras[0]);

  BenchmarkOptions options = Options("3dhp-test", {kTest5});
  options.truth = "annot3";
  ExpectNear(Import(options).dataset.sequences[0].cameras[0].truth.positions(), File("3dhp_test/expected.npz"),
             "TS5|annot3");
  const TemporaryFolder folder;
  WriteDataset(folder / "a.h5", dataset);
  const Dataset read = ReadDataset(folder / "a.h5");
  EXPECT_EQ(read.sequences[1].action, dataset.sequences[1].action);
  EXPECT_TRUE(read.HasTruth());
}

/// An annot_data.mat with other arrays; the file's own names.
void WriteTestSet(const fs::path& path, std::size_t frames, std::size_t joints, float scale, bool with_valid) {
  h5::File from = h5::File::OpenForReading(File(kTest1));
  h5::File file = h5::File::CreateAt(path);
  for (const auto& [name, axes] : {std::pair("annot2", std::size_t{2}), std::pair("univ_annot3", std::size_t{3})}) {
    std::vector<float> values = from.root().Read<float>(name).values;
    values.resize(frames * joints * axes);
    if (axes == 3) {
      for (float& value : values) value *= scale;
    }
    file.root().Write<float>(name, values, {frames, 1, joints, axes});
  }
  if (with_valid) file.root().Write<float>("valid_frame", std::vector<float>(frames, 1.0F), {frames, 1});
  file.Commit();
}

TEST(Mpi3dhpTestTest, NaNIsAMissingJoint) {
  const TemporaryFolder folder;
  const std::string path = folder / "annot_data.mat";
  {
    h5::File from = h5::File::OpenForReading(File(kTest1));
    h5::File file = h5::File::CreateAt(path);
    for (const std::string& name : from.root().Children()) {
      h5::Array<double> array = from.root().Read<double>(name);
      if (name == "univ_annot3") array.values[3 * 4] = NAN;
      file.root().Write<double>(name, array.values, array.shape);
    }
    file.Commit();
  }
  BenchmarkOptions options = Options("3dhp-test", {path});
  options.skeleton = "native";
  options.image_size = {2048, 2048};
  const CameraView view = Import(options).dataset.sequences[0].cameras[0];
  int missing = 0;
  for (int joint = 0; joint < 17; ++joint) missing += view.truth.IsKnown(0, joint) ? 0 : 1;
  EXPECT_EQ(missing, 1);
  EXPECT_FALSE(view.truth.PoseAt(0).row(4).array().isFinite().any());
}

TEST(Mpi3dhpTestTest, InvalidFilesAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "annot_data.mat";
  BenchmarkOptions options = Options("3dhp-test", {path});
  WriteTestSet(path, 8, 17, 1.0F, true);
  EXPECT_THAT(Refusal(options), HasSubstr("TS1 to TS6, from which the image size is known"));
  options.image_size = {800, 600};
  EXPECT_THAT(Import(options).log, HasSubstr("no activity_annotation"));
  WriteTestSet(path, 8, 17, 0.001F, true);
  EXPECT_THAT(Import(options).log, HasSubstr("is in m, by the length of legs"));
  WriteTestSet(path, 8, 17, 7.0F, true);
  EXPECT_THAT(Refusal(options), HasSubstr("in mm, cm or m"));
  WriteTestSet(path, 8, 16, 1.0F, true);
  EXPECT_THAT(Refusal(options),
              AllOf(HasSubstr("/annot2: expected shape (N, 1, 17, 2)"), HasSubstr("found (8, 1, 16, 2)")));
  WriteTestSet(path, 8, 17, 1.0F, false);
  EXPECT_THAT(Refusal(options), HasSubstr("/valid_frame: expected an array, found nothing"));
  EXPECT_THAT(Refusal(Options("3dhp-test", {kTrain1})), HasSubstr("import 3dhp-train"));
  EXPECT_THAT(Refusal(Options("3dhp-test", {"h36m/cameras.json"})), HasSubstr("another format"));
  EXPECT_THAT(Refusal(Options("3dhp-test", {"skipose/test/labels.h5"})), HasSubstr("/annot2"));
}

}  // namespace
}  // namespace canonpose
