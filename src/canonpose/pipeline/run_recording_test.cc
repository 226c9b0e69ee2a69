#include "canonpose/pipeline/run_recording.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/folder_lock.h"
#include "canonpose/base/testing.h"
#include "canonpose/pipeline/run_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::PreparedCommands;
using testing::TemporaryFolder;

/// Two cameras' keypoints.
class RunTest : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteCamera("cam1", "1.3");
    WriteCamera("cam2", "1.3");
    options_.inputs = {(folder_ / "rec").string()};
    options_.output = folder_ / "walk";
    options_.formats = {"csv", "trc"};
  }

  void WriteCamera(const std::string& name, const std::string& version) const {
    fs::create_directories(folder_ / "rec" / name);
    std::ofstream(folder_ / "rec" / name / "frame_0_keypoints.json")
        << R"({"version": )" << version << R"(, "people": []})";
  }

  std::string Refusal(ErrorKind kind) {
    return ErrorOf(kind, [&] { commands_.Run(options_); });
  }

  TemporaryFolder folder_;
  RunOptions options_;
  PreparedCommands commands_;
};

const std::vector<std::string> kAll{"import",     "solve",    "view",  "export csv",
                                    "export trc", "evaluate", "train", "evaluate"};

TEST_F(RunTest, DoesEverythingOnceAndThePageFirst) {
  EXPECT_EQ(commands_.Run(options_), kAll);
  for (const char* name : {"data.h5", "solved.h5", "report.json", "page.html", "exports/poses.trc", "model/model.cpm",
                           "evaluation-solved.json", "commands.sh", "run.json"}) {
    EXPECT_TRUE(fs::exists(options_.output / name)) << name;
  }
  EXPECT_THAT(commands_.Run(options_), IsEmpty());
}

TEST_F(RunTest, ReportsWhatCameOfIt) {
  for (int i = 0; i < 2; ++i) {  // of what is made and of what is there
    commands_.Run(options_);
    const RunReport& report = commands_.report;
    EXPECT_EQ(report.name, "walk");
    EXPECT_THAT(report.trust, ElementsAre("Nothing speaks against this result."));
    EXPECT_THAT(report.used_cameras, ElementsAre("cam1"));
    EXPECT_THAT(report.unused_cameras, ElementsAre("cam2 (late)"));
    EXPECT_EQ(report.people.size(), 1U);
    EXPECT_EQ(report.frames, testing::SolvedCapture().sequences.front().frame_count);
    EXPECT_EQ(report.fps, 25.0);
    EXPECT_EQ(report.exports.size(), 2U);
    EXPECT_EQ(report.page, options_.output / "page.html");
    EXPECT_EQ(report.model, options_.output / "model");
    EXPECT_EQ(report.solved_error_mm, 12.5);
    EXPECT_EQ(report.model_error_mm, 12.5);
  }
}

TEST_F(RunTest, AnOptionGoesToItsCommandAndWhatFollowsIsDoneAgain) {
  commands_.Run(options_);
  options_.fields = {{"height", "1.75"}};
  const std::vector<std::string> executed = commands_.Run(options_);
  EXPECT_EQ(executed.front(), "solve");
  EXPECT_THAT(executed, AllOf(Contains("view"), Contains("export trc"), Contains("train")));
  EXPECT_THAT(commands_.FieldsOf("solve").fields, Contains(std::pair<std::string, std::string>("height", "1.75")));
  options_.fields.emplace_back("epochs", "3");
  EXPECT_THAT(commands_.Run(options_), ElementsAre("train", "evaluate"));
  options_.fields.emplace_back("threads", "1");
  EXPECT_THAT(commands_.Run(options_), IsEmpty()) << "only about speed";
}

TEST_F(RunTest, OtherInputsAreNoticed) {
  commands_.Run(options_);
  WriteCamera("cam2", "1.2");
  EXPECT_EQ(commands_.Run(options_), kAll);
  WriteCamera("cam2", "1.2");
  EXPECT_THAT(commands_.Run(options_), IsEmpty()) << "written again, the same";
}

TEST_F(RunTest, ResultsThatAreGoneAreMadeAgain) {
  commands_.Run(options_);
  fs::remove(options_.output / "page.html");
  fs::remove_all(options_.output / "exports");
  EXPECT_THAT(commands_.Run(options_), ElementsAre("view", "export csv", "export trc"));
  fs::remove(options_.output / "solved.h5");
  EXPECT_THAT(commands_.Run(options_), ElementsAre("solve")) << "to the same bits";
}

TEST_F(RunTest, GoesOnAtTheCommandInWhichItWasKilled) {
  for (const std::string killed : {"import", "solve", "train"}) {
    commands_.before = [&](const std::string& name) {
      if (name == killed) throw std::runtime_error("as if killed");
    };
    EXPECT_THROW(commands_.Run(options_), std::runtime_error);
    EXPECT_EQ(commands_.executed().back(), killed);
    commands_.before = [](const std::string&) {};
  }
  EXPECT_THAT(commands_.Run(options_), ElementsAre("train", "evaluate"));
  EXPECT_THAT(commands_.FieldsOf("train").fields, Contains(std::pair<std::string, std::string>("resume", "")));
}

TEST_F(RunTest, AStepThatFailsIsNamedAndNothingIsLost) {
  commands_.before = [&](const std::string& name) {
    if (name == "solve") throw Error(ErrorKind::kComputation, "diverged");
  };
  EXPECT_THAT(Refusal(ErrorKind::kComputation), AllOf(HasSubstr("diverged"), HasSubstr("in the step solve")));
  EXPECT_THAT(commands_.executed(), ElementsAre("import", "solve"));
  commands_.before = [](const std::string&) {};
  EXPECT_EQ(commands_.Run(options_).front(), "solve");
}

TEST_F(RunTest, ASolutionThatCannotBeBelievedCanBeLookedAt) {
  commands_.after = [&](const std::string& name) {
    if (name == "solve") throw Error(ErrorKind::kComputation, "it cannot be believed");
  };
  EXPECT_THAT(Refusal(ErrorKind::kComputation), HasSubstr("it cannot be believed"));
  EXPECT_THAT(commands_.executed(), ElementsAre("import", "solve", "view"));
  EXPECT_THAT(Refusal(ErrorKind::kComputation), HasSubstr("it cannot be believed")) << "also the second time";
  EXPECT_FALSE(fs::exists(options_.output / "model"));
}

TEST_F(RunTest, WithoutTrainingItEndsWithTheExports) {
  options_.trains = false;
  options_.formats = {"glb"};
  EXPECT_THAT(commands_.Run(options_), ElementsAre("import", "solve", "view", "export glb", "evaluate"));
  EXPECT_TRUE(commands_.report.model.empty());
  commands_.has_calibration = false;
  options_.fields = {{"person", "2"}};
  EXPECT_THAT(commands_.Run(options_), Not(Contains("evaluate"))) << "nothing to compare with";
}

TEST_F(RunTest, FormatsThatStateAFrameRateNeedOne) {
  commands_.fps = 0.0;
  const std::vector<std::string> executed = commands_.Run(options_);
  EXPECT_THAT(executed, AllOf(Contains("export csv"), Not(Contains("export trc"))));
  EXPECT_THAT(commands_.report.formats_left_out, Contains("trc"));
  options_.formats_are_chosen = true;
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), AllOf(HasSubstr("frame rate"), HasSubstr("`fps`")));
}

TEST_F(RunTest, TheNameStaysWhenTheFolderIsRenamed) {
  commands_.Run(options_);
  fs::rename(options_.output, folder_ / "other");
  options_.output = folder_ / "other";
  EXPECT_THAT(commands_.Run(options_), IsEmpty());
  EXPECT_EQ(commands_.report.name, "walk");
}

TEST_F(RunTest, TwoRunsInOneFolderRefuse) {
  commands_.before = [&](const std::string& name) {
    if (name != "solve") return;
    PreparedCommands second;
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { second.Run(options_); }), HasSubstr(options_.output.string()));
    EXPECT_THAT(second.executed(), IsEmpty());
  };
  EXPECT_EQ(commands_.Run(options_), kAll);
}

TEST_F(RunTest, WhatCannotWorkIsRefusedBeforeAnythingIsDone) {
  options_.fields = {{"epochs", "3"}};
  options_.trains = false;
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("`epochs` is for training"));
  options_.fields = {{"height", "175"}};
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("height"));
  options_.fields = {{"image_size", "cam1=1920"}};
  Refusal(ErrorKind::kInvalidArgument);
  options_.fields = {{"search_interval", "5"}};
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("`search_interval` is for videos"));
  options_.fields = {{"calibration", (folder_ / "gone.json").string()}};
  EXPECT_THAT(Refusal(ErrorKind::kBadInput), HasSubstr("gone.json"));
  std::ofstream(folder_ / "calibration.json")
      << R"({"cameras": {"cam1": {"K": [[1500, 0, 960], [0, 1500, 540], [0, 0, 1]],
             "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 4000]}}})";
  options_.fields = {{"calibration", (folder_ / "calibration.json").string()}};
  EXPECT_THAT(Refusal(ErrorKind::kBadInput), HasSubstr("cam2"));
  options_.fields = {{"calibrated_scale", ""}};
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("`calibration`"));
  options_.fields.clear();
  options_.formats = {"docx"};
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), AllOf(HasSubstr("docx"), HasSubstr("trc")));
  EXPECT_THAT(commands_.executed(), IsEmpty());
  EXPECT_FALSE(fs::exists(options_.output));
}

TEST_F(RunTest, FoldersOfSomethingElseAreNotFilled) {
  options_.output = folder_ / "full";
  fs::create_directories(options_.output);
  std::ofstream(options_.output / "thesis.txt") << "text";
  EXPECT_THAT(Refusal(ErrorKind::kBadInput), HasSubstr("thesis.txt"));
  options_.output = folder_ / "rec/out";
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("whose folders are cameras"));
  options_.output = folder_.path();
  EXPECT_THAT(Refusal(ErrorKind::kInvalidArgument), HasSubstr("where the results go"));
  options_.output = folder_ / "empty";
  fs::create_directories(options_.output);
  EXPECT_EQ(commands_.Run(options_), kAll);
}

}  // namespace
}  // namespace canonpose
