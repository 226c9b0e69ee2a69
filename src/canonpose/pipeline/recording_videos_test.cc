// Recordings that are given as videos: which are recognised, and which are detected again.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/pipeline/recording_inputs.h"
#include "canonpose/pipeline/run_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::NamesOf;
using testing::PreparedCommands;
using testing::TemporaryFolder;
using testing::WriteFrame;

TEST(RecordingInputs, AnythingElseIsAVideo) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "rec");
  for (const char* name : {"a.mp4", "b.MP4", "notes.txt"}) std::ofstream(folder / "rec" / name) << "anything";
  // As `detect` leaves them in a folder of videos.
  WriteFrame(folder / "rec/keypoints/a");
  const RecordingInputs inputs = FindRecording({(folder / "rec").string()}, "");
  EXPECT_TRUE(inputs.are_videos);
  EXPECT_FALSE(inputs.are_images);
  EXPECT_THAT(NamesOf(inputs), ElementsAre("a", "b"));
  EXPECT_EQ(inputs.cameras[0].files, std::vector<fs::path>{folder / "rec/a.mp4"});
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindRecording({(folder / "rec/a.mp4").string()}, ""); }),
              AllOf(HasSubstr("at least two cameras"), HasSubstr("one video")));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        FindRecording({(folder / "rec/a.mp4").string(), (folder / "rec/keypoints/a").string()}, "");
                      }),
              HasSubstr("either videos or keypoints"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindRecording({(folder / "gone.mp4").string()}, ""); }),
              HasSubstr("no such file"));
}

class RunOfVideos : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"a.mp4", "b.mp4"}) std::ofstream(folder_ / name) << name;
    options_.inputs = {(folder_ / "a.mp4").string(), (folder_ / "b.mp4").string()};
    options_.output = folder_ / "out";
    options_.trains = false;
    options_.formats = {"csv"};
    commands_.has_calibration = false;
  }

  TemporaryFolder folder_;
  RunOptions options_;
  PreparedCommands commands_;
};

TEST_F(RunOfVideos, FindsPeopleFirst) {
  EXPECT_THAT(commands_.Run(options_), ElementsAre("detect", "import", "solve", "view", "export csv"));
  EXPECT_THAT(commands_.FieldsOf("import").arguments, ElementsAre("openpose", (folder_ / "out/keypoints").string()));
  EXPECT_THAT(commands_.Run(options_), ::testing::IsEmpty());
}

TEST_F(RunOfVideos, AnotherVideoIsDetectedAgainAlone) {
  commands_.Run(options_);
  std::ofstream(folder_ / "b.mp4") << "another take";
  commands_.Run(options_);
  EXPECT_THAT(commands_.keypoints_there_before_detect, ElementsAre("a"))
      << "the other is removed for `detect` to do it";
}

TEST_F(RunOfVideos, OtherOptionsOfTheDetectorAreForAll) {
  commands_.Run(options_);
  options_.fields = {{"most_people", "2"}};
  EXPECT_THAT(commands_.Run(options_), ::testing::Contains("detect"));
  EXPECT_THAT(commands_.keypoints_there_before_detect, ::testing::IsEmpty());
}

TEST_F(RunOfVideos, AVideoLessIsNoCameraAnyMore) {
  std::ofstream(folder_ / "c.mp4") << "c.mp4";
  options_.inputs.push_back((folder_ / "c.mp4").string());
  commands_.Run(options_);
  options_.inputs.pop_back();
  commands_.Run(options_);
  EXPECT_THAT(commands_.keypoints_there_before_detect, ElementsAre("a", "b"));
  EXPECT_FALSE(fs::exists(folder_ / "out/keypoints/c"));
}

TEST_F(RunOfVideos, OptionsForKeypointsAreRefused) {
  options_.fields = {{"layout", "coco-17"}};
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { commands_.Run(options_); }),
              HasSubstr("`layout` is for keypoints"));
  options_.fields = {{"fps", "50"}};
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { commands_.Run(options_); }),
              HasSubstr("videos know their rate"));
  EXPECT_FALSE(fs::exists(options_.output));
}

}  // namespace
}  // namespace canonpose
