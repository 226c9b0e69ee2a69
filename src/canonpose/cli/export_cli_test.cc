// `export` as users see it.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/calibration.h"
#include "canonpose/export/scene_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::Shared;
using testing::TemporaryFolder;

void ExpectRefusal(const std::vector<std::string>& arguments, const ::testing::Matcher<std::string>& matcher) {
  const Outcome outcome = Execute(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.errors;
  EXPECT_THAT(outcome.message(), matcher);
}

TEST(ExportProgram, WritesEveryFormatOfAScene) {
  const TemporaryFolder folder;
  WriteScene(folder / "scene.h5", testing::StaticScene());
  for (const char* const name : {"a.trc", "a.c3d", "a.csv", "a.npz", "a.json", "Calib.toml", "a.yml"}) {
    const Outcome outcome = Execute({"export", folder / "scene.h5", "-o", folder / name});
    EXPECT_EQ(outcome.exit_code, 0) << name << outcome.errors;
    EXPECT_TRUE(fs::exists(folder / name)) << name;
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr(name), HasSubstr("(from the cameras)"), Not(HasSubstr("warning"))));
  }
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "colmap", "--cameras", "colmap"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "colmap/cameras.txt"));
  EXPECT_THAT(ReadFile(folder / "a.trc"), HasSubstr("\tm\t50\t"));
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "a.trc", "--unit", "mm"}).exit_code, 0);
  EXPECT_THAT(ReadFile(folder / "a.trc"), HasSubstr("\tmm\t50\t"));
  ASSERT_EQ(
      Execute({"export", folder / "scene.h5", "-o", folder / "c.json", "--cameras", "json", "--up", "y"}).exit_code, 0);
  EXPECT_EQ(ReadCalibration(folder / "c.json").size(), 3U);
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "c.toml", "--cameras", "anipose"}).exit_code, 0);
  EXPECT_THAT(ReadFile(folder / "c.toml"), HasSubstr("[cam_00]"));
}

TEST(ExportProgram, FiltersAndAnglesOfAPerson) {
  const TemporaryFolder folder;
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  Scene scene = testing::StaticScene();
  PoseSequence person(skeleton, 30);
  person.name = "anna";
  person.unit = LengthUnit::kMillimetres;
  person.fps = 50.0;
  for (int t = 0; t < 30; ++t) {
    for (int j = 0; j < 17; ++j) {
      // Standing: each side to its side, the joints above each other, and shaking.
      const std::string& joint = skeleton.joints[static_cast<std::size_t>(j)];
      const float side = joint.front() == 'L' ? 200.0F : joint.front() == 'R' ? -200.0F : 0.0F;
      const float height = joint.ends_with("Foot")   ? 80.0F
                           : joint.ends_with("Knee") ? 480.0F
                                                     : 900.0F + 40.0F * static_cast<float>(j);
      person.PoseAt(t).row(j) = Eigen::RowVector3f(t % 2 == 0 ? 5.0F : -5.0F, side, height);
    }
  }
  person.TrustKnownJoints();
  scene.people = {person};
  WriteScene(folder / "scene.h5", scene);
  const std::string input = folder / "scene.h5";
  ASSERT_EQ(Execute({"export", input, "-o", folder / "a.csv", "--filter", "5", "--unit", "mm"}).exit_code, 0);
  const std::string csv = ReadFile(folder / "a.csv");
  EXPECT_THAT(csv, AllOf(HasSubstr(",up,processing"), HasSubstr("Butterworth"), HasSubstr("5 Hz")));
  // The middle frame: number, time, and the hip's x, which no longer shakes by 5 mm.
  const std::vector<std::string> cells = testing::Split(testing::Lines(csv).at(16), ',');
  EXPECT_EQ(cells.at(0), "15");
  EXPECT_LT(std::abs(std::stod(cells.at(2))), 0.5);
  for (const char* const name : {"a.mot", "a.sto"}) {
    const Outcome outcome = Execute({"export", input, "-o", folder / name});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("30 frames of 17 joints"));
    EXPECT_THAT(ReadFile(folder / name),
                AllOf(HasSubstr("inDegrees=yes\nendheader\ntime\t"), HasSubstr("knee_angle_l")));
  }
  ExpectRefusal({"export", input, "-o", folder / "a.csv", "--filter", "-1"},
                AllOf(HasSubstr("--filter"), HasSubstr("-1")));
  ExpectRefusal({"export", input, "-o", folder / "a.csv", "--filter", "40"},
                AllOf(HasSubstr("--filter"), HasSubstr("40")));
}

TEST(ExportProgram, OnePersonPerFileWhereTheFormatHasNoMore) {
  const TemporaryFolder folder;
  Scene scene = testing::StaticScene();
  scene.people.push_back(testing::MovingPerson("béla 2", 10));
  WriteScene(folder / "scene.h5", scene);
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "a.trc"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "a_anna.trc") && fs::exists(folder / "a_béla_2.trc"));
  EXPECT_FALSE(fs::exists(folder / "a.trc"));
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "b.trc", "--person", "2"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "b.trc"));
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "a.csv"}).exit_code, 0);
  EXPECT_THAT(ReadFile(folder / "a.csv"), HasSubstr("béla 2:Hip_x [m]"));
  ExpectBadInput({"export", folder / "scene.h5", "-o", folder / "c.csv", "--person", "3"},
                 HasSubstr("expected a person 3, found 2 people; choose another with --person"));
  ExpectRefusal({"export", folder / "scene.h5", "-o", folder / "c.csv", "--person", "anna"}, HasSubstr("--person"));
}

/// Two sequences of one person before two cameras, without up and scale.
Dataset SolvedDataset() {
  Dataset dataset;
  dataset.skeleton = testing::ThreeJoints();
  const Scene scene = testing::UnknownScene(12);
  for (const char* const name : {"walk", "run"}) {
    Sequence sequence;
    sequence.name = name;
    sequence.subject = "anna";
    sequence.capture = "studio";
    sequence.frame_count = 12;
    for (int c = 0; c < 2; ++c) {
      const SceneCamera& camera = scene.cameras[static_cast<std::size_t>(c)];
      CameraView view;
      view.name = camera.name;
      view.image_size = camera.image_size_px;
      view.keypoints.assign(2 * 36, 100.0F);
      view.confidence.assign(36, 0.9F);
      view.confidence[0] = c == 0 ? 0.9F : 0.0F;
      view.solved = PosesInCamera(dataset.skeleton, scene.people[0].positions(), LengthUnit::kBodyLengths, view.name);
      for (int t = 0; t < 12; ++t) {
        for (int j = 0; j < 3; ++j) {
          const Eigen::Vector3d place = testing::PlaceOfJoint(t, j);
          view.solved.PoseAt(t).row(j) = camera.calibration[0].InCamera(place).cast<float>();
        }
      }
      view.solved_calibration = camera.calibration;
      sequence.cameras.push_back(std::move(view));
    }
    dataset.sequences.push_back(std::move(sequence));
  }
  return dataset;
}

TEST(ExportProgram, SolvedDatasets) {
  const TemporaryFolder folder;
  WriteDataset(folder / "solved.h5", SolvedDataset());
  const std::string solved = folder / "solved.h5";
  ExpectBadInput({"export", solved, "-o", folder / "a.c3d"}, AllOf(HasSubstr("run"), HasSubstr("--fps")));
  const Outcome outcome = Execute({"export", solved, "-o", folder / "a.c3d", "--fps", "25"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(fs::exists(folder / "a_walk.c3d") && fs::exists(folder / "a_run.c3d"));
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("warning"), HasSubstr("body lengths, not in metres"),
                                    HasSubstr("which way is up is unknown")));
  EXPECT_EQ(outcome.errors.find("warning"), outcome.errors.rfind("warning")) << "one line for all files";
  // Frame 0, joint 0 was seen by the first camera alone, the next by both: the highest byte of the last number.
  const std::string bytes = ReadFile(folder / "a_walk.c3d");
  const std::size_t data = bytes.size() - 12 * 3 * 16;
  float first = 0.0F;
  float second = 0.0F;
  std::memcpy(&first, &bytes[data + 12], 4);
  std::memcpy(&second, &bytes[data + 28], 4);
  EXPECT_EQ(static_cast<int>(first) >> 8, 1);
  EXPECT_EQ(static_cast<int>(second) >> 8, 3);

  ASSERT_EQ(Execute({"export", solved, "-o", folder / "b.json", "--sequence", "run"}).exit_code, 0);
  EXPECT_THAT(ReadFile(folder / "b.json"), AllOf(HasSubstr("\"name\": \"run\""), HasSubstr("\"up\": \"unknown\"")));
  ExpectBadInput({"export", solved, "-o", folder / "c.json", "--sequence", "jump"},
                 AllOf(HasSubstr("expected a sequence jump"), HasSubstr("walk"), HasSubstr("--sequence")));
}

TEST(ExportProgram, MistakesAreNamed) {
  const TemporaryFolder folder;
  WriteScene(folder / "any.h5", testing::StaticScene());
  ExpectRefusal({"export", folder / "any.h5", "-o", folder / "poses"},
                AllOf(HasSubstr("extension"), HasSubstr("colmap")));
  ExpectRefusal({"export", folder / "any.h5", "-o", folder / "a.csv", "--fps", "0"}, HasSubstr("above 0"));
  WriteScene(folder / "scene.h5", testing::StaticScene());
  const std::string scene = folder / "scene.h5";
  ExpectRefusal({"export", scene, "-o", folder / "a.xyz"}, AllOf(HasSubstr("a.xyz"), HasSubstr(".trc, .c3d")));
  ExpectRefusal({"export", scene, "-o", folder / "a.toml", "--cameras", "opencv"}, HasSubstr("ends in .yml"));
  ExpectRefusal({"export", scene, "-o", folder / "a.toml", "--unit", "mm"}, HasSubstr("in metres; leave out --unit"));
  ExpectRefusal({"export", scene, "-o", folder / "a.trc", "--fps", "10"}, HasSubstr("leave out --fps"));
  ExpectBadInput({"export", folder / "none.h5", "-o", folder / "a.trc"}, HasSubstr("none.h5"));
  WriteFileAtomically(folder / "text.h5", "hello");
  ExpectBadInput({"export", folder / "text.h5", "-o", folder / "a.trc"}, HasSubstr("text.h5"));
  fs::create_directory(folder / "full");
  WriteFileAtomically(folder / "full" / "file", "x");
  ExpectBadInput({"export", scene, "-o", folder / "full", "--cameras", "colmap"}, HasSubstr("full"));
}

/// `import --calibration` reads what `export` wrote.
TEST(ExportProgram, CalibrationsComeBack) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing/calibration.json");
  const TemporaryFolder folder;
  Scene scene = testing::StaticScene();
  scene.cameras.clear();
  for (const auto& [name, calibrated] : ReadCalibration(Shared("data/balancing/calibration.json"))) {
    SceneCamera& camera = scene.cameras.emplace_back();
    camera.name = name;
    camera.image_size_px = *calibrated.image_size;
    camera.calibration = {calibrated.camera};
  }
  WriteScene(folder / "scene.h5", scene);
  std::vector<std::string> files = {Shared("data/balancing/Calib.qca.txt")};
  for (const char* const name : {"Calib.toml", "calibration.yml"}) {
    files.push_back(folder / name);
    ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", files.back()}).exit_code, 0);
  }
  for (const std::string& file : files) {
    const Outcome outcome =
        Execute({"import", "openpose", Shared("data/balancing"), "--calibration", file, "-o", folder / "data.h5"});
    ASSERT_EQ(outcome.exit_code, 0) << file << outcome.errors;
    EXPECT_THAT(outcome.errors, Not(HasSubstr("does not fit"))) << file;
    const Dataset dataset = ReadDataset(folder / "data.h5");
    ASSERT_EQ(dataset.sequences[0].cameras.size(), 4U);
    for (std::size_t c = 0; c < 4; ++c) {
      const Camera& read = dataset.sequences[0].cameras[c].calibration.at(0);
      const Camera& expected = scene.cameras[c].calibration[0];
      EXPECT_LT((read.K - expected.K).norm(), 1e-6) << file;
      EXPECT_LT((read.camera_from_world_rotation - expected.camera_from_world_rotation).norm(), 1e-9) << file;
      EXPECT_LT((read.camera_from_world_translation - expected.camera_from_world_translation).norm(), 0.01) << file;
    }
  }
}

/// What `evaluate` says of a solved dataset, with these calibrations for a reference.
nlohmann::json FiguresOf(const Dataset& solved, const fs::path& file) {
  WriteDataset(file, solved);
  EXPECT_EQ(Execute({"evaluate", file, "--json", file.string() + ".json"}).exit_code, 0);
  return nlohmann::json::parse(ReadFile(file.string() + ".json"));
}

/// Solved cameras that were exported and come back as a calibration give the figures that they give themselves.
TEST(ExportProgram, SolvedCamerasCloseTheCircle) {
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"simulate", "-o", folder / "data.h5", "--openpose", folder / "openpose", "--subjects", "1",
                     "--clips", "1", "--seconds", "2", "--activities", "gait", "--seed", "3"})
                .exit_code,
            0);
  ASSERT_EQ(Execute({"solve", folder / "data.h5", "-o", folder / "solved.h5", "--calibrated-scale", "--threads", "1"})
                .exit_code,
            0);
  Dataset solved = ReadDataset(folder / "solved.h5");
  std::vector<CameraView>& views = solved.sequences[0].cameras;
  for (CameraView& view : views) {
    view.truth = {};
    view.calibration = view.solved_calibration;
  }
  const nlohmann::json expected = FiguresOf(solved, folder / "expected.h5");
  EXPECT_LT(expected["n_mpjpe_mm"], 50.0);
  const std::string clip = fs::directory_iterator(fs::path(folder / "openpose"))->path();
  for (const auto& [name, format] : {std::pair("a.json", "json"), std::pair("Calib.toml", "pose2sim"),
                                     std::pair("b.toml", "anipose"), std::pair("c.yml", "opencv")}) {
    const std::string file = folder / name;
    ASSERT_EQ(Execute({"export", folder / "solved.h5", "-o", file, "--cameras", format}).exit_code, 0);
    const Outcome outcome =
        Execute({"import", "openpose", clip, "--calibration", file, "-o", folder / "back.h5", "--fps", "50"});
    ASSERT_EQ(outcome.exit_code, 0) << name << outcome.errors;
    EXPECT_THAT(outcome.errors, Not(HasSubstr("does not fit"))) << name;
    const Dataset back = ReadDataset(folder / "back.h5");
    ASSERT_EQ(back.sequences[0].cameras.size(), views.size());
    for (std::size_t c = 0; c < views.size(); ++c) {
      EXPECT_EQ(back.sequences[0].cameras[c].name, views[c].name);
      views[c].calibration = back.sequences[0].cameras[c].calibration;
    }
    const nlohmann::json figures = FiguresOf(solved, folder / "again.h5");
    for (const char* const figure : {"n_mpjpe_mm", "p_mpjpe_mm", "cps"}) {
      EXPECT_NEAR(figures[figure].get<double>(), expected[figure].get<double>(), 1e-3) << name << " " << figure;
    }
    EXPECT_LT(figures["cameras"]["ae_deg"].get<double>(), 1e-3) << name;
    EXPECT_LT(figures["cameras"]["te_mm"].get<double>(), 0.1) << name;
  }
}

}  // namespace
}  // namespace canonpose
