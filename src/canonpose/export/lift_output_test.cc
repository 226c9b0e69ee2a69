#include "canonpose/export/lift_output.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/read_scenes.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// Two frames of two joints; the second frame could not be lifted.
LiftedPoses Sample() {
  LiftedPoses poses({"", {"Hip", "Neck, \"upper\""}, {-1, 0}, 0, {0, 1}}, 2, "cam");
  poses.pose_in_camera.positions() = {0, 0, 0, 0.1F, -250.5F, 1e-7F, NAN, NAN, NAN, NAN, NAN, NAN};
  poses.canonical.positions() = {0, 0, 0, 1, 2, 3, NAN, NAN, NAN, NAN, NAN, NAN};
  poses.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  poses.frames = {10, 11};
  poses.pose_in_camera.confidence() = {1.0F, 0.25F, 0.0F, 0.0F};
  poses.pose_in_camera.unit = poses.canonical.unit = LengthUnit::kMillimetres;
  return poses;
}

TEST(LiftOutputTest, Npz) {
  const TemporaryFolder folder;
  WriteLiftOutput(folder / "a.npz", Sample());
  const NpzReader reader(folder / "a.npz");
  EXPECT_THAT(reader.names(), ElementsAre("pose3d", "confidence", "standard_deviation", "canonical", "rotation",
                                          "joints", "parents", "frames", "time", "units"));
  std::vector<std::size_t> shape;
  EXPECT_EQ(reader.ReadFloats("pose3d", &shape)[4], -250.5F);
  EXPECT_THAT(shape, ElementsAre(2, 2, 3));
  EXPECT_THAT(reader.ReadFloats("confidence", &shape), ElementsAre(1.0F, 0.25F, 0.0F, 0.0F));
  EXPECT_THAT(shape, ElementsAre(2, 2));
  EXPECT_TRUE(std::isnan(reader.ReadFloats("standard_deviation", &shape)[0])) << "unknown so far";
  EXPECT_THAT(shape, ElementsAre(2, 2));
  (void)reader.ReadFloats("rotation", &shape);
  EXPECT_THAT(shape, ElementsAre(2, 3, 3));
  EXPECT_THAT(reader.ReadStrings("units"), ElementsAre("mm"));
  EXPECT_EQ(reader.Read("parents").shape, std::vector<std::size_t>{2});
  EXPECT_EQ(reader.ReadFloats("parents", &shape), (std::vector<float>{-1, 0}));
  EXPECT_TRUE(std::isnan(reader.ReadFloats("time", &shape)[0])) << "the frame rate is unknown";
  LiftedPoses timed = Sample();
  timed.pose_in_camera.fps = 50.0;
  WriteLiftOutput(folder / "b.npz", timed);
  EXPECT_THAT(NpzReader(folder / "b.npz").ReadFloats("time", &shape), ElementsAre(0.2F, 0.22F));
}

TEST(LiftOutputTest, Csv) {
  const TemporaryFolder folder;
  LiftedPoses poses = Sample();
  WriteLiftOutput(folder / "a.csv", poses);
  EXPECT_EQ(ReadFile(folder / "a.csv"),
            "frame,Hip_x [mm],Hip_y [mm],Hip_z [mm],\"Neck, \"\"upper\"\"_x [mm]\",\"Neck, \"\"upper\"\"_y [mm]\","
            "\"Neck, \"\"upper\"\"_z [mm]\",Hip_confidence,\"Neck, \"\"upper\"\"_confidence\",Hip_sd [mm],"
            "\"Neck, \"\"upper\"\"_sd [mm]\"\n"
            "10,0,0,0,0.1,-250.5,1e-07,1,0.25,,\n"
            "11,,,,,,,0,0,,\n");
  poses.pose_in_camera.fps = 50.0;
  WriteLiftOutput(folder / "a.csv", poses);
  EXPECT_THAT(ReadFile(folder / "a.csv"), HasSubstr("\n10,0.200000,0,"));
}

TEST(LiftOutputTest, Json) {
  const TemporaryFolder folder;
  LiftedPoses poses = Sample();
  poses.pose_in_camera.fps = 29.97;
  WriteLiftOutput(folder / "a.json", poses);
  const std::string text = ReadFile(folder / "a.json");
  EXPECT_THAT(text, HasSubstr("[0.1, -250.5, 1e-07]")) << "floats must not grow digits";
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["fps"], 29.97);
  EXPECT_EQ(json["joints"][1], "Neck, \"upper\"");
  EXPECT_EQ(json["parents"], (std::vector<int>{-1, 0}));
  EXPECT_EQ(json["frames"], (std::vector<int>{10, 11}));
  EXPECT_NEAR(json["time"][1].get<double>(), 11 / 29.97, 1e-9);
  EXPECT_EQ(json["pose3d"].size(), 2U);
  EXPECT_TRUE(json["pose3d"][1][0][2].is_null());
  EXPECT_EQ(json["confidence"], (nlohmann::json{{1.0, 0.25}, {0.0, 0.0}}));
  EXPECT_TRUE(json["standard_deviation"][1][0].is_null());
  EXPECT_EQ(json["canonical"][0][1][2], 3.0);
  EXPECT_EQ(json["rotation"][0][2][2], 1.0);
}

TEST(LiftOutputTest, NoFramesStillMakeAFile) {
  const TemporaryFolder folder;
  const LiftedPoses poses({"", {"Hip"}, {-1}, 0, {0}}, 0, "cam");
  for (const char* name : {"a.npz", "a.csv", "a.json"}) WriteLiftOutput(folder / name, poses);
  EXPECT_EQ(ReadFile(folder / "a.csv"),
            "frame,Hip_x [network units],Hip_y [network units],Hip_z [network units],"
            "Hip_confidence,Hip_sd [network units]\n");
  EXPECT_TRUE(nlohmann::json::parse(ReadFile(folder / "a.json"))["pose3d"].empty());
  EXPECT_TRUE(nlohmann::json::parse(ReadFile(folder / "a.json"))["confidence"].empty());
}

TEST(LiftOutputTest, OtherExtensionsAreAUsageError) {
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { WriteLiftOutput("a.txt", Sample()); }),
              HasSubstr(".npz, .csv, .json or .h5"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { RequireLiftFormat("poses"); }), HasSubstr("poses"));
}

/// Files for programs, and the scene, lead to the same scene.
TEST(LiftOutputTest, IsReadBackAsAScene) {
  const TemporaryFolder folder;
  LiftedPoses poses = Sample();
  poses.pose_in_camera.fps = 29.97;
  for (const char* const name : {"a.npz", "a.json", "a.h5"}) {
    SCOPED_TRACE(name);
    WriteLiftOutput(folder / name, poses);
    const std::vector<Scene> scenes = ReadScenes(folder / name);
    ASSERT_EQ(scenes.size(), 1U);
    EXPECT_EQ(scenes[0].name, "a");
    EXPECT_EQ(scenes[0].up.source, "a camera that is taken to be level");
    EXPECT_TRUE(scenes[0].scale.is_known()) << "millimetres";
    EXPECT_TRUE(scenes[0].cameras.empty());
    ASSERT_EQ(scenes[0].people.size(), 1U);
    const PoseSequence& person = scenes[0].people[0];
    EXPECT_EQ(person.skeleton().joints, poses.skeleton().joints);
    EXPECT_EQ(person.skeleton().parents, poses.skeleton().parents);
    EXPECT_EQ(person.PoseAt(0).row(1), Eigen::RowVector3f(0.1F, 1e-7F, 250.5F)) << "up is minus down";
    EXPECT_FALSE(person.IsKnown(1, 0));
    EXPECT_EQ(person.confidence(), poses.pose_in_camera.confidence());
    EXPECT_EQ(person.fps, 29.97);
    EXPECT_THAT(person.time_seconds, ElementsAre(10 / 29.97, 11 / 29.97));
  }
}

}  // namespace
}  // namespace canonpose
