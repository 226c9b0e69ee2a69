#include "canonpose/data/image_size_check.h"

#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::IsEmpty;

/// (N, 2) pixels about the centre of an image, reaching over `share` of its width and height.
std::vector<float> Fill(int width, int height, double share) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(static_cast<float>(0.5 - 0.5 * share),
                                              static_cast<float>(0.5 + 0.5 * share));
  std::vector<float> keypoints;
  for (int i = 0; i < 400; ++i) {
    keypoints.push_back(place(random) * static_cast<float>(width));
    keypoints.push_back(place(random) * static_cast<float>(height));
  }
  keypoints.insert(keypoints.end(), 2, std::numeric_limits<float>::quiet_NaN());
  return keypoints;
}

auto OfSize(int width, int height) { return Field(&OtherImageSize::size, std::array<int, 2>{width, height}); }

TEST(ImageSizeCheck, SaysNothingOfTheRightSizeHoweverSmallThePersonIs) {
  for (const double share : {0.2, 0.6, 0.95}) {
    EXPECT_THAT(OtherImageSizes(Fill(1920, 1080, share), {1920, 1080}, 0.12), IsEmpty()) << share;
  }
}

TEST(ImageSizeCheck, FindsTheSizeOfAScaledVideo) {
  EXPECT_THAT(OtherImageSizes(Fill(960, 540, 0.8), {1920, 1080}, 0.12), Contains(OfSize(960, 540)));
  EXPECT_THAT(OtherImageSizes(Fill(1280, 720, 0.8), {1920, 1080}, 0.12), Contains(OfSize(1280, 720)));
  EXPECT_THAT(OtherImageSizes(Fill(640, 360, 0.8), {1920, 1080}, 0.12), Contains(OfSize(640, 360)));
  EXPECT_THAT(OtherImageSizes(Fill(1920, 1080, 0.8), {960, 540}, 0.12), Contains(OfSize(1920, 1080)));
}

TEST(ImageSizeCheck, FindsThatWidthAndHeightAreExchanged) {
  const std::vector<OtherImageSize> others = OtherImageSizes(Fill(1088, 1920, 0.5), {1920, 1088}, 0.12);
  ASSERT_THAT(others, Contains(OfSize(1088, 1920)));
  EXPECT_TRUE(others.front().is_turned);
  EXPECT_THAT(OtherImageSizes(Fill(1000, 1000, 0.9), {1000, 1000}, 0.12), IsEmpty());
}

TEST(ImageSizeCheck, SaysNothingOfTooFewKeypoints) {
  EXPECT_THAT(OtherImageSizes({}, {1920, 1080}, 0.12), IsEmpty());
  EXPECT_THAT(OtherImageSizes(std::vector<float>(20, 100.0F), {1920, 1080}, 0.12), IsEmpty());
}

}  // namespace
}  // namespace canonpose
