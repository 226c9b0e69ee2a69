#include "canonpose/data/readers/video_facts.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void WriteFacts(const testing::TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "video.json") << text;
}

TEST(VideoFacts, ReadsWhatDetectWrites) {
  const testing::TemporaryFolder folder;
  EXPECT_FALSE(ReadVideoFacts(folder.path()));
  EXPECT_FALSE(ReadVideoFacts(folder / "gone"));
  WriteFacts(folder, R"({"format": "canonpose-video", "version": 1, "image_size": [1080, 1920], "fps": 59.94,
                         "frames_skipped": 2, "time_stamps": [0, 0.0167, 0.0334], "anything": "else"})");
  const std::optional<VideoFacts> facts = ReadVideoFacts(folder.path());
  ASSERT_TRUE(facts);
  EXPECT_THAT(facts->image_size, ElementsAre(1080, 1920));
  EXPECT_DOUBLE_EQ(facts->fps, 59.94);
  EXPECT_THAT(facts->times_seconds, ElementsAre(0.0, 0.0167, 0.0334));
  EXPECT_EQ(facts->frames_skipped, 2);
}

TEST(VideoFacts, LeavesOutWhatImagesDoNotHave) {
  const testing::TemporaryFolder folder;
  WriteFacts(folder, R"({"format": "canonpose-video", "version": 1, "image_size": [64, 48]})");
  const std::optional<VideoFacts> facts = ReadVideoFacts(folder.path());
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->fps, 0.0);
  EXPECT_TRUE(facts->times_seconds.empty());
}

TEST(VideoFacts, IgnoresFilesOfOtherPrograms) {
  const testing::TemporaryFolder folder;
  WriteFacts(folder, R"({"title": "my holiday"})");
  EXPECT_FALSE(ReadVideoFacts(folder.path()));
}

TEST(VideoFacts, RefusesDamagedFiles) {
  const testing::TemporaryFolder folder;
  const auto message = [&](const std::string& members) {
    WriteFacts(folder, R"({"format": "canonpose-video", )" + members + "}");
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { ReadVideoFacts(folder.path()); });
  };
  EXPECT_THAT(message(R"("version": 2)"), HasSubstr("version 1"));
  EXPECT_THAT(message(R"("version": 1, "image_size": [1080])"),
              AllOf(HasSubstr("image_size"), HasSubstr("width and height")));
  EXPECT_THAT(message(R"("version": 1, "image_size": [0, 1920])"), HasSubstr("width and height"));
  EXPECT_THAT(message(R"("version": 1, "image_size": [64, 48], "time_stamps": [0, 0.1, 0.1])"),
              AllOf(HasSubstr("time_stamps[2]"), HasSubstr("a later time")));
  EXPECT_THAT(message(R"("version": 1, "image_size": [64, 48], "fps": -3)"), HasSubstr("frames per second"));
}

}  // namespace
}  // namespace canonpose
