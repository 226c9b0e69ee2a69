// The command `run`: everything from keypoints to a model, its log, and that it goes on when it was killed.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::HasTrained;
using testing::ModelFolder;
using ::testing::Not;
using testing::Outcome;
using testing::TemporaryFolder;

/// Keypoints of a simulated person in four cameras, as OpenPose writes them; made once.
const fs::path& Recording() {
  static const TemporaryFolder folder;
  static const fs::path recording = [] {
    const Outcome made =
        Execute({"simulate", "-o", folder / "truth.h5", "--subjects", "1", "--clips", "1", "--activities", "dance",
                 "--seconds", "4", "--fps", "15", "--openpose", folder / "clips"});
    EXPECT_EQ(made.exit_code, 0) << made.errors;
    fs::path clip;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "clips")) clip = entry.path();
    return clip;
  }();
  return recording;
}

/// A run with a network that learns next to nothing.
std::vector<std::string> ShortRun(const fs::path& output, const std::string& epochs = "1") {
  return {"run",          Recording().string(),
          "-o",           output.string(),
          "--image-size", "1000x1000",
          "--fps",        "15",
          "--height",     "1.7",
          "--set",        "min_steps=0",
          "--width",      "16",
          "--epochs",     epochs};
}

/// The results, and their bytes.
std::map<std::string, std::string> ResultsIn(const fs::path& folder) {
  std::map<std::string, std::string> results;
  for (const char* name : {"data.h5", "solved.h5", "report.json", "page.html", "exports/poses.csv", "exports/poses.trc",
                           "exports/poses.c3d", "exports/poses.bvh", "model/model.cpm"}) {
    EXPECT_TRUE(fs::exists(folder / name)) << name;
    if (fs::exists(folder / name)) results[name] = ReadFile(folder / name);
  }
  return results;
}

void ExpectSameResults(const fs::path& folder, const std::map<std::string, std::string>& expected) {
  for (const auto& [name, bytes] : ResultsIn(folder)) {
    EXPECT_TRUE(expected.contains(name) && bytes == expected.at(name)) << name << " differs";
  }
}

TEST(ProgramRun, DoesEverythingAndItsLogDoesItAgain) {
  const TemporaryFolder folder;
  const fs::path output = folder / "walk it";  // a name that a shell would split
  const Outcome first = Execute(ShortRun(output));
  ASSERT_TRUE(HasTrained(first)) << first.errors;
  const std::map<std::string, std::string> results = ResultsIn(output);
  EXPECT_LT(first.errors.find("Making the page"), first.errors.find("Training a network"));
  EXPECT_THAT(first.errors, Not(HasSubstr("next: canonpose"))) << "advice for those who call the commands one by one";

  fs::create_directories(folder / "again");
  const std::string script =
      fmt::format("cd '{}' && sh -e '{}' >out 2>err", (folder / "again").string(), (output / "commands.sh").string());
  const int status = std::system(script.c_str());
  EXPECT_EQ(WEXITSTATUS(status), first.exit_code) << ReadFile(folder / "again/err");
  ExpectSameResults(folder / "again", results);

  const Outcome second = Execute(ShortRun(output));
  EXPECT_THAT(second.errors,
              AllOf(HasSubstr("Finding cameras and 3D poses: done before"), Not(HasSubstr("frames of"))));
  ExpectSameResults(output, results);
}

TEST(ProgramRun, KilledItGoesOnToTheSameBits) {
  const TemporaryFolder folder;  // the recording is named after the last part
  const Outcome whole = Execute(ShortRun(folder / "whole/run", "3"));
  ASSERT_TRUE(HasTrained(whole)) << whole.errors;
  for (const char* until : {"data.h5", "model/metrics.jsonl"}) {
    const pid_t child = testing::Start(ShortRun(folder / "killed/run", "3"), folder / "out", folder / "err");
    for (int i = 0; i < 6000 && !fs::exists(folder / "killed/run" / until); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(child, SIGKILL);
    testing::Wait(child);
    EXPECT_TRUE(fs::exists(folder / "killed/run" / until)) << until << ReadFile(folder / "err");
  }
  const Outcome last = Execute(ShortRun(folder / "killed/run", "3"));
  EXPECT_EQ(last.exit_code, whole.exit_code) << last.errors;
  EXPECT_THAT(last.errors, HasSubstr("Making the page: done before"));
  ExpectSameResults(folder / "killed/run", ResultsIn(folder / "whole/run"));
}

TEST(ProgramRun, StoppedBySignalItSaysHowToGoOn) {
  const TemporaryFolder folder;
  const pid_t child = testing::Start(ShortRun(folder / "run", "1000"), folder / "out", folder / "err");
  for (int i = 0; i < 6000 && !fs::exists(folder / "run/model/metrics.jsonl"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ExpectBadInput(ShortRun(folder / "run", "1000"), HasSubstr((folder / "run").string()));  // while the first is at work
  kill(child, SIGTERM);
  EXPECT_EQ(testing::Wait(child), 128 + SIGTERM);
  EXPECT_THAT(ReadFile(folder / "err"), AllOf(HasSubstr("stopped; to continue, run the same command again"),
                                              Not(HasSubstr("--resume")), Not(HasSubstr("error"))));
}

TEST(ProgramRun, ClosingLinesSayWhatANewcomerNeeds) {
  const TemporaryFolder folder;
  std::vector<std::string> words = ShortRun(folder / "run");
  words.resize(words.size() - 6);
  words.insert(words.end(), {"--no-train", "--export", "csv,glb"});
  const Outcome outcome = Execute(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("run: one person from 4 cameras, 60 frames at 15 per second"),
                                    HasSubstr("this result: "), HasSubstr((folder / "run/page.html").string()),
                                    HasSubstr("exports/poses.csv"), HasSubstr("exports/poses.glb"),
                                    HasSubstr("without --no-train"), HasSubstr("Lengths are in millimetres.")));
  EXPECT_NE(ReadFile(folder / "run/page.html").find("<title>run"), std::string::npos);
}

TEST(ProgramRun, RefusesBeforeAnythingIsDone) {
  const TemporaryFolder folder;
  EXPECT_EQ(Execute({"run"}).exit_code, 2);
  const fs::path output = folder / "out";
  const auto refusal = [&](const std::vector<std::string>& options, const char* message) {
    std::vector<std::string> words{"run", Recording().string(), "-o", output.string()};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = Execute(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.errors;
    EXPECT_THAT(outcome.message(), HasSubstr(message));
    EXPECT_FALSE(fs::exists(output)) << message;
  };
  refusal({"--height", "1,75"}, "--height");
  refusal({"--person", "all", "--epochs", "0"}, "epochs");
  refusal({"--set", "wdth=16"}, "wdth");
  refusal({"--bootstrap", "magic"}, "--bootstrap");
  refusal({"--no-train", "--epochs", "3"}, "--epochs is for training");
  ExpectBadInput({"run", (folder / "gone.mp4").string(), "-o", output.string()}, HasSubstr("gone.mp4"));
  // Sizes that nothing says.
  ExpectBadInput({"run", Recording().string(), "-o", output.string()}, HasSubstr("--image-size"));
}

/// The first frames of a video as another, so that people are found in it in less time.
void WriteBeginning(const fs::path& video, const fs::path& name, int frames) {
  cv::VideoCapture reader(video.string());
  cv::Mat frame;
  cv::VideoWriter writer;
  for (int i = 0; i < frames && reader.read(frame); ++i) {
    if (i == 0) {
      writer.open(name.string() + ".avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), reader.get(cv::CAP_PROP_FPS),
                  frame.size());
    }
    writer.write(frame);
  }
}

TEST(ProgramRun, MakesAPageOfVideos) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/videos/one/cam01.mp4");
  if (!fs::exists(ModelFolder() / "movenet-multipose.bin")) {
    GTEST_SKIP() << ModelFolder() << " does not have the detector; scripts/get-detector downloads it";
  }
  const TemporaryFolder folder;
  fs::create_directories(folder / "one");
  for (const char* name : {"cam01", "cam02", "cam03", "cam04"}) {
    WriteBeginning(testing::Shared("data/videos/one") / (name + std::string(".mp4")), folder / "one" / name, 20);
  }
  const std::vector<std::string> words{
      "run", (folder / "one").string(), "-o", (folder / "out").string(), "--no-train", "--export", "csv"};
  const Outcome outcome = Execute(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("out: one person from 4 cameras, 20 frames at 60 per second"));
  EXPECT_TRUE(fs::exists(folder / "out/page.html"));
  EXPECT_THAT(Execute(words).errors, HasSubstr("Finding people in 4 videos: done before"));
}

}  // namespace
}  // namespace canonpose
