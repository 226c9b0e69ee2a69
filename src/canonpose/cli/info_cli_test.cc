// `info` as users and other programs see it.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/dataset.h"
#include "canonpose/export/scene_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::TemporaryFolder;
using testing::TestData;

json InfoOf(const fs::path& path) {
  const Outcome outcome = Execute({"info", path, "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const json info = json::parse(outcome.output, nullptr, /*allow_exceptions=*/false);
  EXPECT_TRUE(info.is_object()) << outcome.output;
  EXPECT_EQ(info.value("file", ""), path);
  return info;
}

std::string TextOf(const fs::path& path) { return Execute({"info", path}).output; }

TEST(InfoProgram, DescribesAScene) {
  const TemporaryFolder folder;
  const Scene scene = testing::StaticScene();
  WriteScene(folder / "scene.h5", scene);
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "scene.json"}).exit_code, 0);
  ASSERT_EQ(Execute({"export", folder / "scene.h5", "-o", folder / "scene.csv"}).exit_code, 0);
  for (const char* const name : {"scene.h5", "scene.json"}) {
    const json info = InfoOf(folder / name);
    EXPECT_EQ(info["kind"], "scene") << name;
    EXPECT_EQ(info["frames"], scene.people[0].frame_count()) << name;
    ASSERT_EQ(info["people"].size(), scene.people.size()) << name;
    EXPECT_EQ(info["people"][0]["joints"], scene.people[0].skeleton().joints) << name;
    ASSERT_EQ(info["cameras"].size(), scene.cameras.size()) << name;
    EXPECT_EQ(info["cameras"][0]["image_size"], scene.cameras[0].image_size_px) << name;
    EXPECT_THAT(TextOf(folder / name), AllOf(HasSubstr("scene: people and cameras"), HasSubstr(scene.cameras[1].name)))
        << name;
  }
  EXPECT_EQ(InfoOf(folder / "scene.csv")["written_by"], "export");
}

TEST(InfoProgram, DescribesADataset) {
  const TemporaryFolder folder;
  const std::string file = folder / "people.h5";
  ASSERT_EQ(
      Execute({"simulate", "-o", file, "--subjects", "1", "--clips", "2", "--seconds", "1", "--fps", "10"}).exit_code,
      0);
  const json info = InfoOf(file);
  const Dataset dataset = ReadDataset(file);
  EXPECT_EQ(info["kind"], "dataset");
  EXPECT_EQ(info["frames"], 20);
  EXPECT_EQ(info["skeleton"]["name"].is_null(), dataset.skeleton.name.empty());
  EXPECT_EQ(info["skeleton"]["joints"], dataset.skeleton.joints);
  EXPECT_EQ(info["skeleton"]["parents"], dataset.skeleton.parents);
  EXPECT_EQ(info["skeleton"]["root"], dataset.skeleton.root);
  EXPECT_EQ(info["source"]["format"], "simulated");
  ASSERT_EQ(info["sequences"].size(), 2U);
  const json& sequence = info["sequences"][1];
  const Sequence& expected = dataset.sequences[1];
  EXPECT_EQ(sequence["name"], expected.name);
  EXPECT_EQ(sequence["subject"], expected.subject);
  EXPECT_EQ(sequence["frames"], 10);
  EXPECT_EQ(sequence["fps"], 10.0);
  EXPECT_EQ(sequence["static_cameras"], true);
  EXPECT_EQ(sequence["capture"], expected.capture);
  EXPECT_EQ(sequence["actions"], expected.actions);
  EXPECT_TRUE(sequence["truth_kind"].is_null());
  ASSERT_EQ(sequence["cameras"].size(), expected.cameras.size());
  const json& camera = sequence["cameras"][0];
  EXPECT_EQ(camera["name"], expected.cameras[0].name);
  EXPECT_EQ(camera["image_size"], expected.cameras[0].image_size);
  EXPECT_GT(camera["seen_percent"], 50.0);
  EXPECT_EQ(camera["truth"], true);
  EXPECT_EQ(camera["solved"], false);
  EXPECT_EQ(camera["calibrated"], true);
  EXPECT_THAT(TextOf(file), AllOf(HasSubstr("kind         dataset\n"),
                                  HasSubstr("fingerprint " + info["fingerprint"].get<std::string>()),
                                  HasSubstr("sequence     " + expected.name + ": subject " + expected.subject),
                                  HasSubstr("10 frames at 10/s, static cameras"), HasSubstr(", truth, calibrated\n")));
}

TEST(InfoProgram, DescribesABenchmarksActionsAndKindOfTruth) {
  const json info = InfoOf(TestData("protocols/3dhp.h5"));
  EXPECT_EQ(info["sequences"][0]["truth_kind"], "univ_annot3");
  const json human = InfoOf(TestData("protocols/h36m.h5"));
  EXPECT_FALSE(human["sequences"][0]["actions"].empty());
  EXPECT_TRUE(human["sequences"][0]["fps"].is_null() || human["sequences"][0]["fps"] > 0.0);
}

TEST(InfoProgram, DescribesModelsAndCheckpoints) {
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  const std::string run = folder / "run";
  ASSERT_EQ(
      Execute({"simulate", "-o", data, "--subjects", "1", "--clips", "2", "--seconds", "2", "--fps", "10"}).exit_code,
      0);
  ASSERT_TRUE(testing::HasTrained(Execute({"train", data, "-o", run, "--preset", "paper", "--width", "16", "--epochs",
                                           "2", "--seed", "3", "--threads", "1"})));
  const json info = InfoOf(run);
  EXPECT_EQ(info["kind"], "model");
  EXPECT_EQ(info["preset"], "paper");
  EXPECT_EQ(info["network"], "canonical");
  EXPECT_EQ(info["width"], 16);
  EXPECT_EQ(info["seed"], 3);
  EXPECT_GT(info["steps"], 0);
  EXPECT_FALSE(info["program_version"].get<std::string>().empty());
  EXPECT_TRUE(info["mirror"]["decision"].is_string());
  EXPECT_EQ(info["mirror"]["slope"].is_null(), info["mirror"]["slope_error"].is_null());
  EXPECT_TRUE(info["trap"]["verdict"].is_string());
  EXPECT_TRUE(info["trap"]["depth_ratio"].is_number());
  EXPECT_TRUE(info["morph"].is_null());
  EXPECT_TRUE(info["perspective"].is_null());
  ASSERT_EQ(info["data"].size(), 1U);
  EXPECT_EQ(info["data"][0]["file"], "data.h5");
  EXPECT_EQ(info["data"][0]["fingerprint"], InfoOf(data)["fingerprint"]);
  EXPECT_EQ(info["skeleton"], InfoOf(data)["skeleton"]);
  EXPECT_EQ(info["source"], InfoOf(data)["source"]);
  EXPECT_EQ(info["options"]["epochs"], 2);
  EXPECT_THAT(TextOf(run),
              AllOf(HasSubstr("kind         model\n"), HasSubstr("preset paper, network canonical, width 16"),
                    HasSubstr("mirror       " + info["mirror"]["decision"].get<std::string>()),
                    HasSubstr("trap         " + info["trap"]["verdict"].get<std::string>()),
                    HasSubstr("options      {\""), HasSubstr("\"epochs\":2")));

  EXPECT_EQ(InfoOf(fs::path(run) / "model.cpm")["options"], info["options"]);
  EXPECT_EQ(InfoOf(fs::path(run) / "checkpoint.h5")["kind"], "checkpoint");
  fs::remove(fs::path(run) / "model.cpm");
  const json unfinished = InfoOf(run);
  EXPECT_EQ(unfinished["kind"], "checkpoint");
  EXPECT_EQ(unfinished["steps"], info["steps"]);
  EXPECT_TRUE(unfinished["trap"].is_null());
  EXPECT_THAT(TextOf(run), HasSubstr("kind         checkpoint of an unfinished or finished training run\n"));
}

TEST(InfoProgram, ListsTheArraysOfAnArchive) {
  const TemporaryFolder folder;
  NpzWriter writer(folder / "poses.npz");
  writer.Add("pose3d", std::vector<float>(12), {2, 2, 3});
  writer.AddString("units", "mm");
  writer.Commit();
  const json info = InfoOf(folder / "poses.npz");
  EXPECT_EQ(info["kind"], "npz");
  const json expected = {{{"name", "pose3d"}, {"shape", {2, 2, 3}}, {"text", nullptr}},
                         {{"name", "units"}, {"shape", json::array()}, {"text", "mm"}}};
  EXPECT_EQ(info["arrays"], expected);
  EXPECT_THAT(TextOf(folder / "poses.npz"),
              AllOf(HasSubstr("array        pose3d: (2, 2, 3)\n"), HasSubstr("array        units: mm\n")));
}

TEST(InfoProgram, KnowsTablesAndReports) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "poses.csv",
                      "frame,time [s],Hip_x [mm],Hip_y [mm],Hip_z [mm],\"A,b_x [mm]\",\"A,b_y "
                      "[mm]\",\"A,b_z [mm]\"\n3,0.1,0,0,0,1,2,3\n4,0.2,0,0,0,1,2,3\n");
  json info = InfoOf(folder / "poses.csv");
  EXPECT_EQ(info["kind"], "poses");
  EXPECT_EQ(info["frames"], 2);
  EXPECT_EQ(info["units"], "mm");
  EXPECT_EQ(info["joints"], (json{"Hip", "A,b"}));
  EXPECT_THAT(TextOf(folder / "poses.csv"), HasSubstr("2 frames of 2 joints in mm"));
  WriteFileAtomically(folder / "poses.json",
                      R"({"units": "network units", "joints": ["Hip"], "frames": [7], "pose3d": [[[0, 0, 0]]]})");
  info = InfoOf(folder / "poses.json");
  EXPECT_EQ(info["kind"], "poses");
  EXPECT_EQ(info["frames"], 1);

  const std::string data = TestData("protocols/h36m.h5");
  ASSERT_EQ(
      Execute({"evaluate", data, "--json", folder / "figures.json", "--frame-errors", folder / "errors.csv"}).exit_code,
      0);
  info = InfoOf(folder / "figures.json");
  EXPECT_EQ(info["kind"], "evaluation");
  EXPECT_GT(info["n_mpjpe_mm"], 0.0);
  EXPECT_THAT(TextOf(folder / "figures.json"), AllOf(HasSubstr("figures, written by evaluate"), HasSubstr("N-MPJPE")));
  EXPECT_EQ(InfoOf(folder / "errors.csv")["poses"], info["frames"]);
  EXPECT_THAT(TextOf(folder / "errors.csv"), HasSubstr("errors of single poses"));
  ASSERT_EQ(Execute({"evaluate", "--list-protocols", "--json", folder / "list.json"}).exit_code, 0);
  EXPECT_THAT(TextOf(folder / "list.json"), HasSubstr("protocols    5"));

  WriteFileAtomically(folder / "other.csv", "a,b\n1,2\n");
  ExpectBadInput({"info", folder / "other.csv"}, AllOf(HasSubstr("other.csv"), HasSubstr("found another table")));
  WriteFileAtomically(folder / "other.json", "{\"people\": []}");
  ExpectBadInput({"info", folder / "other.json"}, HasSubstr("found other JSON"));
}

TEST(InfoProgram, RefusesWhatItCannotRead) {
  const TemporaryFolder folder;
  ExpectBadInput({"info", folder / "none", "--json"}, HasSubstr("none"));
  WriteFileAtomically(folder / "text.h5", "no dataset");
  const Outcome outcome = Execute({"info", folder / "text.h5", "--json"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.output, "");
  for (const char* const text : {R"({"format": "canonpose-scene-json", "people": [{}], "cameras": 3})",
                                 R"({"pose3d": 1, "joints": 1, "units": 2})"}) {
    WriteFileAtomically(folder / "other.json", text);
    ExpectBadInput({"info", folder / "other.json"}, AllOf(HasSubstr("other.json"), HasSubstr("other contents")));
  }
}

TEST(InfoProgram, AVideoNeedsADetector) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.avi", "RIFF1234AVI LIST");
  ExpectBadInput({"info", folder / "a.avi"}, AllOf(HasSubstr("a video"), HasSubstr("2D keypoint detector")));
  const std::string data = folder / "data.h5";
  ASSERT_EQ(
      Execute({"simulate", "-o", data, "--subjects", "1", "--clips", "1", "--seconds", "2", "--fps", "10"}).exit_code,
      0);
  ASSERT_TRUE(testing::HasTrained(Execute({"train", data, "-o", folder / "run", "--preset", "supervised", "--width",
                                           "16", "--epochs", "1", "--threads", "1"})));
  ExpectBadInput({"lift", folder / "run", folder / "a.avi", "-o", folder / "x.npz"},
                 AllOf(HasSubstr("a video"), HasSubstr("2D keypoint detector")));
}

}  // namespace
}  // namespace canonpose
