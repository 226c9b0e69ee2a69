#include "canonpose/data/readers/frame_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using Names = std::vector<std::string>;

TEST(LastNumber, IsTheFrameNumber) {
  EXPECT_EQ(LastNumber("cam01.0012.json"), 12);
  EXPECT_EQ(LastNumber("video_000000000007_keypoints.json"), 7);
  EXPECT_EQ(LastNumber("7.jpg"), 7);
  EXPECT_EQ(LastNumber("cam01.0012"), 12);
  EXPECT_EQ(LastNumber("clip2_0003_keypoints_2d.json"), 3);
  EXPECT_EQ(LastNumber("0005.mp4"), 5);
  EXPECT_EQ(LastNumber("left.jpg"), std::nullopt);
  EXPECT_GT(LastNumber("99999999999999999999999999999.jpg").value_or(0), 0);
}

/// The times between the names, in units of the last decimal.
std::vector<std::int64_t> Steps(const Names& names, double seconds_per_number) {
  const FrameNumbers found = NumberFrames(names);
  EXPECT_EQ(found.seconds_per_number, seconds_per_number) << names.front();
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < found.numbers.size(); ++i) steps.push_back(found.numbers[i] - found.numbers[i - 1]);
  return steps;
}

TEST(NumberFrames, NamesAreTimesInManyForms) {
  EXPECT_THAT(Steps({"1714564803.960403_keypoints.json", "1714564804.000412_keypoints.json"}, 1e-6),
              ElementsAre(40009));
  // Decimals count from the point, however many there are.
  EXPECT_THAT(Steps({"1714564803.96.json", "1714564804.0.json", "1714564804.04.json"}, 0.01), ElementsAre(4, 4));
  EXPECT_THAT(Steps({"1714564803_960403.jpg", "1714564804_000412.jpg"}, 1e-6), ElementsAre(40009));
  EXPECT_THAT(Steps({"frame1714564803960.png", "frame1714564804000.png"}, 1e-3), ElementsAre(40));
  EXPECT_THAT(Steps({"1714564803960403.json", "1714564804000403.json"}, 1e-6), ElementsAre(40000));
  EXPECT_THAT(Steps({"1714564803960403000.json", "1714564804000403000.json"}, 1e-9), ElementsAre(40000000));
  EXPECT_THAT(Steps({"cam_2024-05-01_11-59-59.960.json", "cam_2024-05-01_12-00-00.000.json"}, 1e-3), ElementsAre(40));
  EXPECT_THAT(Steps({"2024-12-31T23:59:59.980_keypoints.json", "2025-01-01T00:00:00.020_keypoints.json"}, 1e-3),
              ElementsAre(40));
  EXPECT_THAT(Steps({"20240501_115959_960403.json", "20240501_120000_000403.json"}, 1e-6), ElementsAre(40000));
  EXPECT_THAT(Steps({"20240501_115959960.json", "20240501_120000000.json"}, 1e-3), ElementsAre(40));
  EXPECT_THAT(Steps({"20240501115959960.json", "20240501120000000.json"}, 1e-3), ElementsAre(40));
  EXPECT_THAT(Steps({"115959.960.json", "120000.000.json"}, 1e-3), ElementsAre(40));
  EXPECT_THAT(Steps({"2.960.json", "3.000.json", "3.040.json"}, 1e-3), ElementsAre(40, 40));
}

TEST(NumberFrames, CountersAreNotTimes) {
  for (const Names& names :
       {Names{"cam01.0001.json", "cam01.0002.json"},
        Names{"20240501_120003_000001.json", "20240501_120003_000002.json"},
        Names{"1714564803_000001.json", "1714564803_000002.json"}, Names{"1.0001.json", "1.0002.json"},
        Names{"take2_0001.json", "take2_0002.json"}, Names{"v1.2_001.json", "v1.2_002.json"}}) {
    const FrameNumbers found = NumberFrames(names);
    EXPECT_THAT(found.numbers, ElementsAre(1, 2)) << names.front();
    EXPECT_EQ(found.seconds_per_number, 0.0) << names.front();
  }
}

TEST(NumberFrames, TheNumberThatDiffersCounts) {
  EXPECT_THAT(NumberFrames({"0001_cam1.json", "0002_cam1.json", "0004_cam1.json"}).numbers, ElementsAre(1, 2, 4));
  EXPECT_THAT(NumberFrames({"f1_1920x1080.json", "f2_1920x1080.json", "f3_1920x1080.json"}).numbers,
              ElementsAre(1, 2, 3));
  // Two cameras in one folder.
  EXPECT_THAT(NumberFrames({"cam1_0001.json", "cam2_0001.json"}).numbers, ElementsAre(1, 1));
}

}  // namespace
}  // namespace canonpose
