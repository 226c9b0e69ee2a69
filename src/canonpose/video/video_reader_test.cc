#include "canonpose/video/video_reader.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/video/video_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

VideoSource Source(const fs::path& path) { return FindVideos({path.string()}).front(); }

/// The numbers of all frames, after checking that they are counted and their times grow.
std::vector<int> ReadNumbers(VideoReader& reader) {
  std::vector<int> numbers;
  VideoFrame frame;
  double last = -1.0;
  while (reader.Read(frame)) {
    EXPECT_EQ(frame.index, std::ssize(numbers));
    EXPECT_TRUE(std::isnan(frame.time_seconds) || frame.time_seconds > last);
    last = frame.time_seconds;
    numbers.push_back(testing::NumberOf(frame.image));
  }
  return numbers;
}

TEST(VideoReader, ReadsFramesWithTheirTimes) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedVideo(folder / "a.avi", 10, 25.0);
  VideoReader reader(Source(folder / "a.avi"));
  EXPECT_THAT(reader.info().image_size, ElementsAre(64, 48));
  EXPECT_DOUBLE_EQ(reader.info().fps, 25.0);
  EXPECT_EQ(reader.info().frame_count, 10);
  EXPECT_EQ(reader.info().rotation_degrees, 0);
  VideoFrame frame;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(reader.Read(frame));
    EXPECT_EQ(testing::NumberOf(frame.image), i);
    EXPECT_NEAR(frame.time_seconds, i / 25.0, 1e-6);
  }
  EXPECT_FALSE(reader.Read(frame));
  EXPECT_EQ(reader.skipped(), 0);
}

TEST(VideoReader, CountsTheFramesThatAVideoCutOffLacks) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedVideo(folder / "a.avi", 20, 25.0, {320, 240});
  fs::resize_file(folder / "a.avi", fs::file_size(folder / "a.avi") * 3 / 5);
  VideoReader reader(Source(folder / "a.avi"));
  const long read = std::ssize(ReadNumbers(reader));
  EXPECT_GT(read, 2);
  EXPECT_LT(read, 20);
  EXPECT_EQ(reader.skipped(), 20 - read);
}

TEST(VideoReader, CountsWhatAnMkvCutOffLacksByItsDuration) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedVideo(folder / "a.mkv", 30, 25.0, {320, 240});
  fs::resize_file(folder / "a.mkv", fs::file_size(folder / "a.mkv") * 3 / 5);
  VideoReader reader(Source(folder / "a.mkv"));
  const long read = std::ssize(ReadNumbers(reader));
  EXPECT_GT(read, 2);
  EXPECT_LT(read, 25);
  EXPECT_NEAR(static_cast<double>(reader.skipped()), static_cast<double>(30 - read), 1.0);
}

TEST(VideoReader, MissesNoFramesWhereOnlyTheStatedRateIsWrong) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedVideo(folder / "a.mkv", 20, 25.0);
  // 20 ms per frame instead of 40: 50 frames per second, and so 40 frames.
  std::string bytes = ReadFile(folder / "a.mkv");
  const std::string duration_of_25 = std::string("\x23\xE3\x83\x84", 4) + std::string("\x02\x62\x5A\x00", 4);
  const std::size_t place = bytes.find(duration_of_25);
  ASSERT_NE(place, std::string::npos);
  bytes.replace(place + 4, 4, std::string("\x01\x31\x2D\x00", 4));
  WriteFileAtomically(folder / "a.mkv", bytes);
  VideoReader reader(Source(folder / "a.mkv"));
  EXPECT_EQ(reader.info().frame_count, 40) << "which the container does not hold";
  EXPECT_THAT(ReadNumbers(reader), SizeIs(20));
  EXPECT_EQ(reader.skipped(), 0);
  EXPECT_EQ(reader.times_corrected(), 0);
}

TEST(VideoReader, ReadsImages) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedImages(folder / "cam", 12);
  VideoReader reader(Source(folder / "cam"), 50.0);
  EXPECT_THAT(reader.info().image_size, ElementsAre(64, 48));
  EXPECT_THAT(ReadNumbers(reader), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
}

TEST(VideoReader, PassesOverDamagedImagesButKeepsTime) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedImages(folder / "cam", 4);
  std::ofstream(folder / "cam/image_1.png") << "no image";
  VideoReader reader(Source(folder / "cam"), 10.0);
  VideoFrame frame;
  ASSERT_TRUE(reader.Read(frame));
  ASSERT_TRUE(reader.Read(frame));
  EXPECT_EQ(testing::NumberOf(frame.image), 2);
  EXPECT_NEAR(frame.time_seconds, 0.2, 1e-9);
  EXPECT_EQ(reader.skipped(), 1);
}

TEST(VideoReader, KnowsNoTimesOfImagesWithoutARate) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedImages(folder / "cam", 2);
  VideoReader reader(Source(folder / "cam"));
  VideoFrame frame;
  ASSERT_TRUE(reader.Read(frame));
  EXPECT_TRUE(std::isnan(frame.time_seconds));
  EXPECT_EQ(reader.info().fps, 0.0);
}

TEST(VideoReader, RefusesFilesThatAreNoVideo) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "empty.mp4").close();
  std::ofstream(folder / "text.mp4") << "hello";
  std::ofstream(folder / "numbers.h5") << "\x89HDF\r\n\x1a\n" << std::string(100, 'x');
  const auto message = [&](const char* name) {
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { const VideoReader reader(Source(folder / name)); });
  };
  EXPECT_THAT(message("empty.mp4"), AllOf(HasSubstr("empty.mp4"), HasSubstr("an empty file")));
  EXPECT_THAT(message("text.mp4"), HasSubstr("a video that can be read"));
  EXPECT_THAT(message("numbers.h5"), HasSubstr("HDF5"));
}

TEST(VideoReader, RefusesImagesOfSeveralSizes) {
  const testing::TemporaryFolder folder;
  testing::WriteNumberedImages(folder / "cam", 3);
  cv::imwrite((folder / "cam/image_2.png").string(), testing::NumberedImage(2, {32, 48}));
  VideoReader reader(Source(folder / "cam"));
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { ReadNumbers(reader); }),
              AllOf(HasSubstr("64x48"), HasSubstr("32x48")));
}

TEST(VideoReader, ReadsARealRecordingToItsEnd) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/videos/one/cam01.mp4");
  VideoReader reader(Source(testing::Shared("data/videos/one/cam01.mp4")));
  EXPECT_THAT(reader.info().image_size, ElementsAre(1080, 1920));
  VideoFrame frame;
  long frames = 0;
  for (; reader.Read(frame); ++frames) EXPECT_NEAR(frame.time_seconds, static_cast<double>(frames) / 60.0, 2e-4);
  EXPECT_EQ(frames, 100);
  EXPECT_EQ(reader.times_corrected(), 0) << "though the last two have no stamps";
}

}  // namespace
}  // namespace canonpose
