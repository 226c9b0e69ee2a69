#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/video/video_reader.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void Touch(const fs::path& path) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << "x";
}

std::vector<std::string> NamesOf(const std::vector<VideoSource>& sources) {
  std::vector<std::string> names;
  for (const VideoSource& source : sources) names.push_back(source.name);
  return names;
}

TEST(FindVideos, TakesVideosFoldersOfVideosAndPatterns) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"cam2.mp4", "cam1.MOV", "notes.txt", ".hidden.mp4"}) Touch(folder / name);
  EXPECT_THAT(NamesOf(FindVideos({(folder / "cam2.mp4").string()})), ElementsAre("cam2"));
  EXPECT_THAT(NamesOf(FindVideos({folder.path().string()})), ElementsAre("cam1", "cam2"));
  EXPECT_THAT(NamesOf(FindVideos({(folder / "c?m*.mp4").string()})), ElementsAre("cam2"));
}

TEST(FindVideos, OrdersImagesByTheirNumbers) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"shot/f_10.png", "shot/f_9.png", "shot/f_1.jpg"}) Touch(folder / name);
  for (const std::string& path :
       {(folder / "shot").string(), (folder / "shot/").string(), (folder / "shot/f_*").string()}) {
    const std::vector<VideoSource> sources = FindVideos({path});
    ASSERT_EQ(sources.size(), 1U);
    EXPECT_EQ(sources[0].name, "shot");
    std::vector<std::string> files;
    for (const fs::path& image : sources[0].images) files.push_back(image.filename().string());
    EXPECT_THAT(files, ElementsAre("f_1.jpg", "f_9.png", "f_10.png"));
  }
}

TEST(FindVideos, NamesSourcesAfterTheFolderAboveWhereNamesAreTheSame) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"a/GX01.mp4", "b/GX01.mp4"}) Touch(folder / name);
  EXPECT_THAT(NamesOf(FindVideos({(folder / "a/GX01.mp4").string(), (folder / "b/GX01.mp4").string()})),
              ElementsAre("a-GX01", "b-GX01"));
  const std::string twice = (folder / "a/GX01.mp4").string();
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput,
                               [&] {
                                 FindVideos({twice, twice});
                               }),
              HasSubstr("two called a-GX01"));
}

TEST(FindVideos, RefusesWhatCannotBeAVideo) {
  const testing::TemporaryFolder folder;
  Touch(folder / "one.png");
  Touch(folder / "text/a.txt");
  Touch(folder / "both/a.mp4");
  Touch(folder / "both/a.png");
  const auto message = [&](const char* name) {
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { FindVideos({(folder / name).string()}); });
  };
  EXPECT_THAT(message("gone.mp4"), HasSubstr("no such file"));
  EXPECT_THAT(message("one.png"), HasSubstr("give the folder"));
  EXPECT_THAT(message("text"), AllOf(HasSubstr("only other files"), HasSubstr("a.txt")));
  EXPECT_THAT(message("both"), HasSubstr("both: a.mp4 and a.png"));
  EXPECT_THAT(message("x*.mp4"), HasSubstr("no file"));
}

}  // namespace
}  // namespace canonpose
