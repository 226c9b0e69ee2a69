// The command `detect`: what it refuses, and one video from end to end where the detector is on this machine.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/dataset.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Execute;
using ::testing::HasSubstr;
using testing::ModelFolder;
using testing::Outcome;
using testing::TemporaryFolder;

TEST(ProgramDetect, SaysHowToGetTheDetector) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.mp4") << "anything";
  testing::ExpectBadInput(
      {"detect", (folder / "a.mp4").string(), "-o", (folder / "out").string(), "--model", (folder / "gone").string()},
      AllOf(HasSubstr("movenet-thunder.json"), HasSubstr("run scripts/get-detector")));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(ProgramDetect, RefusesWrongUsage) {
  EXPECT_EQ(Execute({"detect"}).exit_code, 2);
  EXPECT_EQ(Execute({"detect", "a.mp4"}).exit_code, 2) << "no output";
  const Outcome outcome = Execute({"detect", "a.mp4", "-o", "out", "--search-interval", "0"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.message(), HasSubstr("--search-interval"));
  const Outcome rate = Execute({"detect", "images", "-o", "out", "--fps", "0"});
  EXPECT_EQ(rate.exit_code, 2);
  EXPECT_THAT(rate.message(), HasSubstr("--fps: expected frames per second, above 0"));
}

TEST(ProgramDetect, FindsPeopleThatImportReads) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/videos/one/cam01.mp4");
  if (!fs::exists(ModelFolder() / "movenet-multipose.bin")) {
    GTEST_SKIP() << ModelFolder() << " does not have the detector; scripts/get-detector downloads it";
  }
  const TemporaryFolder folder;
  testing::ExpectBadInput({"detect", (folder / "gone.mp4").string(), "-o", (folder / "out").string()},
                          HasSubstr("no such file"));
  const Outcome detected =
      Execute({"detect", testing::Shared("data/videos/one/cam03.mp4").string(),
               testing::Shared("data/videos/one/cam04.mp4").string(), "-o", (folder / "out").string()});
  ASSERT_EQ(detected.exit_code, 0) << detected.errors;
  EXPECT_THAT(detected.errors, HasSubstr("100 frames of 1088x1920 pixels, 60 per second; one person"));
  const Outcome imported =
      Execute({"import", "openpose", (folder / "out").string(), "-o", (folder / "data.h5").string()});
  ASSERT_EQ(imported.exit_code, 0) << imported.errors;
  const Dataset dataset = ReadDataset(folder / "data.h5");
  EXPECT_EQ(dataset.sequences[0].frame_count, 100);
  EXPECT_EQ(dataset.sequences[0].fps, 60.0);
  EXPECT_EQ(dataset.source.layout, "coco-17");
}

}  // namespace
}  // namespace canonpose
