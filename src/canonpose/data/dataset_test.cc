#include "canonpose/data/dataset.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Skeleton Stick() { return {"stick", {"Hip", "LKnee", "RKnee"}, {-1, 0, 0}, 0, {0, 2, 1}}; }

CameraView ViewOf(const std::string& name, int frames) {
  CameraView view;
  view.name = name;
  view.image_size = {1920, 1080};
  std::vector<float> truth;
  for (int i = 0; i < frames * 3; ++i) {
    view.keypoints.push_back(static_cast<float>(i));
    view.keypoints.push_back(static_cast<float>(2 * i));
    view.confidence.push_back(0.5F);
    for (int axis = 0; axis < 3; ++axis) truth.push_back(static_cast<float>(10 * i + axis));
  }
  view.truth = TruthPoses(Stick(), truth, name);
  return view;
}

Dataset Sample() {
  Dataset dataset;
  dataset.skeleton = Stick();
  dataset.source = {"openpose", "body_25b", 2.0, {"a", "b", "c"}, "the morphing network 12"};
  Sequence walk{"walk", "S1", 50.0, true, "room", 4, {ViewOf("c1", 4), ViewOf("c2", 4)}};
  walk.cameras[0].keypoints[2] = kNaN;
  walk.cameras[0].keypoints[3] = kNaN;
  walk.cameras[0].confidence[1] = 0.0F;
  Camera fixed;
  fixed.K << 1000.5, 0.1, 960, 0, 1001, 540, 0, 0, 1;
  fixed.distortion = {0.1, 0.2, 0.3, 0.4};
  walk.cameras[0].calibration = {fixed};
  walk.cameras[1].calibration = {fixed};
  walk.cameras[1].calibration[0].distortion[4] = 0.5;
  walk.actions = {"Walking", "Sitting / waiting"};
  walk.action = {0, 0, 1, 1};
  walk.truth_kind = "univ_annot3";
  Sequence run{"run", "S1", 25.0, false, "run", 2, {ViewOf("c1", 2)}};
  run.cameras[0].truth = {};
  PoseSequence& solved = run.cameras[0].solved;
  solved = PosesInCamera(Stick(), std::vector<float>(18, 1.5F), LengthUnit::kBodyLengths, "c1");
  solved.standard_deviation().assign(6, 0.25F);
  solved.standard_deviation()[3] = kNaN;
  run.cameras[0].solved_calibration = {fixed};
  run.cameras[0].solved_frames = {-0.5, 1.0};
  for (int frame = 0; frame < 2; ++frame) {
    Camera moving = fixed;
    moving.K(0, 0) += frame;
    moving.camera_from_world_rotation = Eigen::AngleAxisd(0.1 * frame, Eigen::Vector3d::UnitY()).toRotationMatrix();
    moving.camera_from_world_translation = {1.0 * frame, 2.0, 3.0};
    run.cameras[0].calibration.push_back(moving);
  }
  dataset.sequences = {run, walk};  // in the order of the file, which is alphabetical
  return dataset;
}

void ExpectSameValues(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << i;
}

void ExpectSamePoses(const PoseSequence& a, const PoseSequence& b) {
  EXPECT_EQ(a.frame_count(), b.frame_count());
  EXPECT_EQ(a.joint_count(), b.joint_count());
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.coordinate_frame, b.coordinate_frame);
  EXPECT_EQ(a.confidence(), b.confidence());
  ExpectSameValues(a.positions(), b.positions());
  ExpectSameValues(a.standard_deviation(), b.standard_deviation());
}

void ExpectSameCameras(const std::vector<Camera>& a, const std::vector<Camera>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].K, b[i].K);
    EXPECT_EQ(a[i].camera_from_world_rotation, b[i].camera_from_world_rotation);
    EXPECT_EQ(a[i].camera_from_world_translation, b[i].camera_from_world_translation);
    EXPECT_EQ(a[i].distortion, b[i].distortion);
  }
}

TEST(DatasetTest, RoundTripKeepsEverything) {
  const TemporaryFolder folder;
  const Dataset written = Sample();
  WriteDataset(folder / "a.h5", written);
  EXPECT_TRUE(IsDatasetFile(folder / "a.h5"));
  const Dataset read = ReadDataset(folder / "a.h5");
  EXPECT_EQ(read.skeleton.name, "stick");
  EXPECT_TRUE(read.skeleton.SameJoints(written.skeleton));
  EXPECT_EQ(read.source.format, "openpose");
  EXPECT_EQ(read.source.layout, "body_25b");
  EXPECT_EQ(read.source.confidence_scale, 2.0);
  EXPECT_EQ(read.source.mapping, written.source.mapping);
  EXPECT_EQ(read.source.morph, "the morphing network 12");
  ASSERT_EQ(read.sequences.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    const Sequence& a = read.sequences[s];
    const Sequence& b = written.sequences[s];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.subject, b.subject);
    EXPECT_EQ(a.fps, b.fps);
    EXPECT_EQ(a.static_cameras, b.static_cameras);
    EXPECT_EQ(a.capture, b.capture);
    EXPECT_EQ(a.frame_count, b.frame_count);
    EXPECT_EQ(a.actions, b.actions);
    EXPECT_EQ(a.action, b.action);
    EXPECT_EQ(a.truth_kind, b.truth_kind);
    ASSERT_EQ(a.cameras.size(), b.cameras.size());
    for (std::size_t c = 0; c < a.cameras.size(); ++c) {
      EXPECT_EQ(a.cameras[c].name, b.cameras[c].name);
      EXPECT_EQ(a.cameras[c].image_size, b.cameras[c].image_size);
      ExpectSameValues(a.cameras[c].keypoints, b.cameras[c].keypoints);
      ExpectSameValues(a.cameras[c].confidence, b.cameras[c].confidence);
      ExpectSamePoses(a.cameras[c].truth, b.cameras[c].truth);
      ExpectSamePoses(a.cameras[c].solved, b.cameras[c].solved);
      EXPECT_EQ(a.cameras[c].solved_frames, b.cameras[c].solved_frames);
      ExpectSameCameras(a.cameras[c].calibration, b.cameras[c].calibration);
      ExpectSameCameras(a.cameras[c].solved_calibration, b.cameras[c].solved_calibration);
    }
  }
}

TEST(DatasetTest, SameDatasetSameBits) {
  const TemporaryFolder folder;
  WriteDataset(folder / "a.h5", Sample());
  WriteDataset(folder / "b.h5", Sample());
  EXPECT_EQ(ReadFile(folder / "a.h5"), ReadFile(folder / "b.h5"));
}

TEST(DatasetTest, ReportsWhatItContains) {
  Dataset dataset = Sample();
  EXPECT_TRUE(dataset.HasTruth());
  EXPECT_TRUE(dataset.HasSolved());
  EXPECT_TRUE(dataset.HasCalibration());
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      std::ranges::fill(view.truth.positions(), kNaN);
      view.solved = {};
      view.calibration.clear();
    }
  }
  EXPECT_FALSE(dataset.HasTruth());
  EXPECT_FALSE(dataset.HasSolved());
  EXPECT_FALSE(dataset.HasCalibration());
}

TEST(DatasetTest, FingerprintCoversWhatTrainingUses) {
  const std::uint64_t before = Sample().Fingerprint();
  Dataset dataset = Sample();
  dataset.sequences[0].cameras[0].keypoints[0] += 1.0F;
  EXPECT_NE(dataset.Fingerprint(), before);
  dataset = Sample();
  dataset.skeleton.joints[2] = "RightKnee";
  EXPECT_NE(dataset.Fingerprint(), before);
  dataset = Sample();
  dataset.sequences[1].cameras[0].truth = {};
  EXPECT_EQ(dataset.Fingerprint(), before);
}

TEST(DatasetTest, CaptureDefaultsToTheSubjectOnlyForStaticCameras) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  for (Sequence& sequence : dataset.sequences) sequence.capture.clear();
  WriteDataset(folder / "a.h5", dataset);
  const Dataset read = ReadDataset(folder / "a.h5");
  EXPECT_EQ(read.sequences[0].capture, "run");
  EXPECT_EQ(read.sequences[1].capture, "S1");
  // A default stays one however often it is copied; a name stays a name.
  EXPECT_FALSE(read.sequences[1].capture_is_named);
  WriteDataset(folder / "b.h5", read);
  EXPECT_FALSE(ReadDataset(folder / "b.h5").sequences[1].capture_is_named);
  EXPECT_EQ(ReadDataset(folder / "b.h5").sequences[1].capture, "S1");
  WriteDataset(folder / "c.h5", Sample());
  EXPECT_TRUE(ReadDataset(folder / "c.h5").sequences[1].capture_is_named);
}

TEST(DatasetTest, WritesOnlyOnCommit) {
  const TemporaryFolder folder;
  {
    DatasetWriter writer(folder / "a.h5", Stick());
    writer.Add(Sample().sequences[0]);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(DatasetTest, AKeypointMissingInOneArrayIsMissingInBoth) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  CameraView& view = dataset.sequences[0].cameras[0];
  view.keypoints[1] = kNaN;   // joint 0: one coordinate is enough
  view.confidence[2] = 0.0F;  // joint 2: a pixel without confidence
  view.solved.positions()[4] = kNaN;
  WriteDataset(folder / "a.h5", dataset);
  const Dataset dataset_read = ReadDataset(folder / "a.h5");
  const CameraView& read = dataset_read.sequences[0].cameras[0];
  EXPECT_TRUE(std::isnan(read.keypoints[0]));
  EXPECT_EQ(read.confidence[0], 0.0F);
  EXPECT_TRUE(std::isnan(read.keypoints[4]));
  EXPECT_TRUE(std::isnan(read.solved.positions()[3]) && std::isnan(read.solved.positions()[5]));
  EXPECT_EQ(read.solved.confidence(), (std::vector<float>{1, 0, 1, 1, 1, 1}));
}

h5::Group SolvedView(h5::File& file) { return file.root().Open("sequences").Open("run").Open("cameras").Open("c1"); }

TEST(DatasetTest, ConfidencesOfSolvedJointsAreWrittenOnlyIfTheySaySomething) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  PoseSequence& solved = dataset.sequences[0].cameras[0].solved;
  solved.positions()[3] = kNaN;
  WriteDataset(folder / "a.h5", dataset);
  h5::File plain = h5::File::OpenForReading(folder / "a.h5");
  EXPECT_TRUE(SolvedView(plain).Has("solved_uncertainty"));
  EXPECT_FALSE(SolvedView(plain).Has("solved_confidence"));

  solved.confidence()[2] = 0.25F;
  WriteDataset(folder / "b.h5", dataset);
  EXPECT_EQ(ReadDataset(folder / "b.h5").sequences[0].cameras[0].solved.confidence(),
            (std::vector<float>{1, 0, 0.25F, 1, 1, 1}));
  solved.confidence()[2] = 1.5F;
  WriteDataset(folder / "c.h5", dataset);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "c.h5"); }),
              HasSubstr("/c1/solved_confidence, frame 0, joint RKnee: expected a number from 0 to 1, found 1.5"));
}

TEST(DatasetTest, UncertaintiesAreNotWrittenWhereThereAreNone) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  PoseSequence& solved = dataset.sequences[0].cameras[0].solved;
  std::ranges::fill(solved.standard_deviation(), kNaN);
  EXPECT_TRUE(LacksUncertainty(solved));
  WriteDataset(folder / "a.h5", dataset);
  h5::File file = h5::File::OpenForReading(folder / "a.h5");
  EXPECT_FALSE(SolvedView(file).Has("solved_uncertainty"));
  EXPECT_TRUE(LacksUncertainty(ReadDataset(folder / "a.h5").sequences[0].cameras[0].solved));
  // A view without any solved joint has the array as any other.
  std::ranges::fill(solved.positions(), kNaN);
  EXPECT_FALSE(LacksUncertainty(solved));
}

TEST(DatasetTest, KeepFramesCutsEveryArray) {
  Dataset dataset = Sample();
  KeepFrames(dataset, FrameRange::Parse("1-2"), "a.h5");
  ASSERT_EQ(dataset.sequences.size(), 2U);
  EXPECT_EQ(dataset.sequences[0].frame_count, 1);
  EXPECT_EQ(dataset.sequences[0].cameras[0].calibration.size(), 1U);
  EXPECT_EQ(dataset.sequences[0].cameras[0].calibration[0].K(0, 0), 1001.5);
  EXPECT_EQ(dataset.sequences[0].cameras[0].solved_frames, std::vector<double>{0.0});
  EXPECT_EQ(dataset.sequences[1].frame_count, 2);
  EXPECT_EQ(dataset.sequences[1].cameras[1].keypoints.front(), 3.0F);
  EXPECT_EQ(dataset.sequences[1].cameras[1].confidence.size(), 6U);
  EXPECT_EQ(dataset.sequences[1].cameras[1].truth.positions().back(), 82.0F);
  EXPECT_EQ(dataset.sequences[1].action, (std::vector<std::uint8_t>{0, 1}));
  KeepFrames(dataset, {1, 1}, "a.h5");
  EXPECT_EQ(dataset.sequences.size(), 1U);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        KeepFrames(dataset, {7, 9}, "a.h5");
                      }),
              AllOf(HasSubstr("a.h5"), HasSubstr("frames from 7 on")));
}

TEST(ViewClock, FindsTheFrameThatShowsTheSameMoment) {
  const Sequence sequence{"walk", "S1", 50.0, true, "room", 6, {}};
  const auto own_frames = [&](const CameraView& view) {
    const ViewClock clock(sequence, view);
    std::vector<int> frames;
    for (int n = clock.first_frame(); n <= clock.last_frame(); ++n) frames.push_back(clock.OwnFrame(n));
    return frames;
  };
  CameraView view;
  EXPECT_EQ(own_frames(view), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  view.time_offset_seconds = 0.04;
  EXPECT_EQ(own_frames(view), (std::vector<int>{0, 1, 2, 3, 4, 5}));  // of the frames 2 to 7
  EXPECT_EQ(ViewClock(sequence, view).OwnFrame(2), 0);
  EXPECT_EQ(ViewClock(sequence, view).OwnFrame(1), -1);
  view.solved_frames = {1.0, 3.2, kNaN, 7.0, 4.5, 0.0};
  EXPECT_EQ(own_frames(view), (std::vector<int>{5, 0, -1, 1, -1, -1}));
}

TEST(DatasetTest, ActionsMustBeNamed) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  dataset.sequences[1].action[2] = 2;
  WriteDataset(folder / "a.h5", dataset);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "a.h5"); }),
              AllOf(HasSubstr("/sequences/walk/action"), HasSubstr("actions, which has 2, found 2")));
}

TEST(DatasetTest, FramesBeyondTheEndAreRefused) {
  FrameRange::Parse("0-99").RequireLast(100, "a.h5");
  FrameRange::Parse("50-").RequireLast(100, "a.h5");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { FrameRange::Parse("10-500").RequireLast(100, "a.h5"); }),
              AllOf(HasSubstr("a.h5: expected frames up to 500"), HasSubstr("`frames=10-99`")));
}

TEST(DatasetTest, NamesOfOtherKindsOfFilesAreRefused) {
  for (const char* name : {"a.h5", "b/a.HDF5", "a", "take.1/a"}) RequireDatasetName(name);
  for (const char* name : {"a.csv", "sol.json", "a.npz"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { RequireDatasetName(name); }),
                HasSubstr("HDF5 file; name it"));
  }
}

TEST(DatasetTest, FrameRangesParse) {
  EXPECT_EQ(FrameRange::Parse("3-9").last, 9);
  EXPECT_EQ(FrameRange::Parse("3-").last, INT32_MAX);
  EXPECT_EQ(FrameRange::Parse("3").last, 3);
  for (const char* text : {"", "-", "-3", "9-3", "a-b", "1-2-3", "1.5", "99999999999"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { FrameRange::Parse(text); }), HasSubstr("A-B")) << text;
  }
}

// ------------------------------------------------------------------------------------------------------- bad files

/// A correct file except for what `change` does; every part of it can be left out or changed.
struct RawFile {
  std::string format = "canonpose-dataset";
  std::int64_t version = 1;
  std::vector<std::string> joints = {"Hip", "LKnee", "RKnee"};
  std::vector<std::int64_t> parents = {-1, 0, 0};
  std::vector<std::int64_t> image_size = {640, 480};
  std::int64_t static_cameras = 1;
  std::vector<std::size_t> keypoints_shape = {2, 3, 2};
  std::vector<std::size_t> confidence_shape = {2, 3};
  std::vector<std::size_t> second_camera_shape = {2, 3, 2};
  std::vector<std::size_t> truth_shape;
  float keypoint = 1.0F;
  float confidence = 1.0F;
  std::vector<double> R;
};

std::vector<float> Filled(const std::vector<std::size_t>& shape, float value) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  return std::vector<float>(count, value);
}

void Write(const RawFile& raw, const std::filesystem::path& path) {
  h5::File file = h5::File::CreateAt(path);
  {
    h5::Group& root = file.root();
    root.SetString("format", raw.format);
    root.SetInt("version", raw.version);
    h5::Group skeleton = root.Create("skeleton");
    skeleton.SetStrings("joints", raw.joints);
    skeleton.SetInts("parents", raw.parents);
    skeleton.SetInt("root", 0);
    skeleton.SetInts("mirror", {0, 2, 1});
    h5::Group sequence = root.Create("sequences").Create("walk");
    sequence.SetString("subject", "S1");
    sequence.SetInt("static_cameras", raw.static_cameras);
    h5::Group cameras = sequence.Create("cameras");
    for (const char* name : {"c1", "c2"}) {
      const bool second = std::strcmp(name, "c2") == 0;
      h5::Group camera = cameras.Create(name);
      camera.SetInts("image_size", raw.image_size);
      const std::vector<std::size_t> shape = second ? raw.second_camera_shape : raw.keypoints_shape;
      std::vector<float> keypoints = Filled(shape, 1.0F);
      if (second) keypoints[9] = raw.keypoint;
      camera.Write<float>("keypoints", keypoints, shape);
      std::vector<float> confidence = Filled(raw.confidence_shape, 1.0F);
      if (second) confidence[4] = raw.confidence;
      camera.Write<float>("confidence", confidence, raw.confidence_shape);
      if (!raw.truth_shape.empty()) {
        camera.Write<float>("truth", Filled(raw.truth_shape, 1.0F), raw.truth_shape);
      }
      if (!raw.R.empty()) {
        camera.Write<double>("K", std::vector<double>{500, 0, 1, 0, 500, 1, 0, 0, 1}, {3, 3});
        camera.Write<double>("R", raw.R, {3, 3});
        camera.Write<double>("t", std::vector<double>{0, 0, 0}, {3});
      }
    }
  }
  file.Commit();
}

std::string ErrorOfChange(const std::function<void(RawFile&)>& change) {
  const TemporaryFolder folder;
  RawFile raw;
  change(raw);
  Write(raw, folder / "bad.h5");
  std::string message = ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "bad.h5"); });
  EXPECT_THAT(message, HasSubstr("bad.h5"));
  return message;
}

TEST(DatasetFileTest, AMinimalFileIsEnough) {
  const TemporaryFolder folder;
  Write(RawFile(), folder / "a.h5");
  const Dataset dataset = ReadDataset(folder / "a.h5");
  EXPECT_EQ(dataset.sequences[0].frame_count, 2);
  EXPECT_EQ(dataset.sequences[0].fps, 0.0);
  EXPECT_EQ(dataset.sequences[0].capture, "S1");
  EXPECT_EQ(dataset.source.confidence_scale, 1.0);
}

TEST(DatasetFileTest, ErrorsSayWhereAndWhat) {
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.format = "canonpose-model"; }),
              AllOf(HasSubstr("canonpose-dataset"), HasSubstr("canonpose-model"), HasSubstr("canonpose import")));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.version = 3; }),
              AllOf(HasSubstr("expected 1 or 2, found 3"), HasSubstr("update")));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.joints.pop_back(); }), HasSubstr("/skeleton"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.parents = {-1, 2, 1}; }), HasSubstr("LKnee"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) {
                raw.parents = {-1, std::int64_t{1} << 32, 0};
              }),
              AllOf(HasSubstr("attribute parents"), HasSubstr("found 4294967296")));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.image_size = {0, 480}; }), HasSubstr("/c1/attribute image_size"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.image_size = {640}; }), HasSubstr("1 numbers"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.static_cameras = 2; }), HasSubstr("static_cameras"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) {
                raw.keypoints_shape = {2, 4, 2};
              }),
              AllOf(HasSubstr("/sequences/walk/cameras/c1/keypoints"), HasSubstr("(2, 4, 2)")));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.keypoints_shape = {0, 3, 2}; }), HasSubstr("(0, 3, 2)"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.confidence_shape = {2, 3, 1}; }), HasSubstr("(2, 3, 1)"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) {
                raw.second_camera_shape = {5, 3, 2};
              }),
              AllOf(HasSubstr("/c2/keypoints"), HasSubstr("expected 2 frames"), HasSubstr("found 5")));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.truth_shape = {2, 3, 2}; }), HasSubstr("/c1/truth"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.keypoint = INFINITY; }),
              AllOf(HasSubstr("/c2/keypoints, frame 1, joint LKnee"), HasSubstr("found inf")));
  for (const float value : {1.5F, -0.1F, kNaN}) {
    EXPECT_THAT(ErrorOfChange([&](RawFile& raw) { raw.confidence = value; }),
                HasSubstr("/c2/confidence, frame 1, joint LKnee: expected a number from 0 to 1"));
  }
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.R = {2, 0, 0, 0, 1, 0, 0, 0, 1}; }), HasSubstr("not orthonormal"));
  EXPECT_THAT(ErrorOfChange([](RawFile& raw) { raw.R = {1, 0, 0, 0, 1, 0, 0, 0, -1}; }), HasSubstr("reflection"));
}

TEST(DatasetFileTest, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.txt", "hello");
  EXPECT_FALSE(IsDatasetFile(folder / "a.txt"));
  EXPECT_FALSE(IsDatasetFile(folder / "nothing"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "nothing"); }), HasSubstr("nothing"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "a.txt"); }), HasSubstr("HDF5"));
  h5::File other = h5::File::CreateAt(folder / "other.h5");
  other.root().SetInt("format", 3);
  other.Commit();
  EXPECT_FALSE(IsDatasetFile(folder / "other.h5"));
}

TEST(DatasetFileTest, ATruncatedFileIsRefused) {
  const TemporaryFolder folder;
  WriteDataset(folder / "a.h5", Sample());
  const std::string whole = ReadFile(folder / "a.h5");
  for (const std::size_t size : {whole.size() / 2, whole.size() - 100}) {
    WriteFileAtomically(folder / "cut.h5", std::string_view(whole).substr(0, size));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "cut.h5"); }), HasSubstr("cut.h5"));
  }
}

/// libhdf5 crashes on some of these files, and on others it would run for ever.
TEST(DatasetFileTest, FilesWithReplacedBytesAreReadOrRefused) {
  const TemporaryFolder folder;
  WriteDataset(folder / "a.h5", Sample());
  const std::string whole = ReadFile(folder / "a.h5");
  Rng rng(41);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    // Half of them in the first part, where headers and texts are.
    const std::size_t range = i % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 4096);
    for (std::size_t n = 0; n <= rng.Index(2); ++n) {
      bytes[rng.Index(range)] = static_cast<char>(n % 2 == 0 ? 0xFF : rng.Index(256));
    }
    std::ofstream(folder / "b.h5", std::ios::binary) << bytes;
    try {
      ReadDataset(folder / "b.h5");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(DatasetFileTest, NamesThatCannotBeGroupsAreRefused) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  dataset.sequences[0].name = "a/b";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteDataset(folder / "a.h5", dataset); }), HasSubstr("a/b"));
  dataset.sequences[0].name = dataset.sequences[1].name;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteDataset(folder / "a.h5", dataset); }), HasSubstr("two called"));
}

TEST(ReadDataset, AVideoNeedsADetector) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.avi", "RIFF1234AVI LIST");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "a.avi"); }),
              HasSubstr("expected a dataset, found a video; run a 2D keypoint detector on it"));
}

/// Two people in the first camera, nobody in the second.
Dataset WithTracks() {
  Dataset dataset = Sample();
  Sequence& walk = dataset.sequences[1];
  for (CameraView& view : walk.cameras) {
    CameraTrack track{"0001", std::move(view.keypoints), std::move(view.confidence)};
    view.keypoints.assign(24, kNaN);
    view.confidence.assign(12, 0.0F);
    if (view.name != "c1") continue;
    view.tracks = {track, track};
    view.tracks[1].id = "0002";
    for (float& value : view.tracks[1].keypoints) value += 1.0F;
  }
  return dataset;
}

TEST(DatasetFile, KeepsTracksOfSeveralPeople) {
  const TemporaryFolder folder;
  const Dataset dataset = WithTracks();
  WriteDataset(folder / "data.h5", dataset);
  const Dataset read = ReadDataset(folder / "data.h5", TracksInDataset::kAllowed);
  EXPECT_FALSE(read.sequences[0].HasTracks());
  const Sequence& walk = read.sequences[1];
  EXPECT_TRUE(walk.HasTracks());
  EXPECT_EQ(walk.frame_count, 4);
  EXPECT_TRUE(walk.cameras[1].tracks.empty());
  EXPECT_EQ(walk.cameras[1].calibration.size(), 1U);
  ASSERT_EQ(walk.cameras[0].tracks.size(), 2U);
  EXPECT_EQ(walk.cameras[0].tracks[1].id, "0002");
  EXPECT_EQ(walk.cameras[0].tracks[1].keypoints[0], 1.0F);
  EXPECT_EQ(walk.cameras[0].tracks[0].confidence, dataset.sequences[1].cameras[0].tracks[0].confidence);
  EXPECT_EQ(read.Fingerprint(), dataset.Fingerprint());
}

TEST(DatasetFile, OnlyWithTracksIsItOfAnotherVersion) {
  const TemporaryFolder folder;
  WriteDataset(folder / "one.h5", Sample());
  WriteDataset(folder / "several.h5", WithTracks());
  EXPECT_EQ(h5::File::OpenForReading(folder / "one.h5").root().GetInt("version"), 1);
  EXPECT_EQ(h5::File::OpenForReading(folder / "several.h5").root().GetInt("version"), 2);
}

TEST(DatasetFile, TracksAreRefusedWhereOnePersonIsNeeded) {
  const TemporaryFolder folder;
  WriteDataset(folder / "data.h5", WithTracks());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadDataset(folder / "data.h5"); }),
              AllOf(HasSubstr("/sequences/walk"), HasSubstr("run `canonpose solve` first")));
}

TEST(DatasetFile, KeepsWhoWasFilmedTogether) {
  const TemporaryFolder folder;
  Dataset dataset = Sample();
  dataset.sequences[1].scene = "hall";
  WriteDataset(folder / "data.h5", dataset);
  const Dataset read = ReadDataset(folder / "data.h5");
  EXPECT_EQ(read.sequences[0].scene, "");
  EXPECT_EQ(read.sequences[1].scene, "hall");
}

TEST(KeepFrames, AlsoOfTracks) {
  Dataset dataset = WithTracks();
  const float third = dataset.sequences[1].cameras[0].tracks[1].keypoints[12];
  KeepFrames(dataset.sequences[1], 2, 3);
  EXPECT_EQ(dataset.sequences[1].cameras[0].tracks[1].keypoints.size(), 12U);
  EXPECT_EQ(dataset.sequences[1].cameras[0].tracks[1].keypoints[0], third);
}

}  // namespace
}  // namespace canonpose
