#include "canonpose/detect/crop.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

using testing::StandingPerson;

constexpr float kScale = 2.0F / 255.0F;

TEST(CropAround, HoldsTheWholePersonAboutTheHips) {
  const Crop crop = CropAround(StandingPerson(500, 300, 60), 1280, 720);
  const Eigen::Vector2f middle = crop.corner + Eigen::Vector2f::Constant(0.5F * crop.size);
  EXPECT_NEAR(middle.x(), 500, 1e-3);
  EXPECT_NEAR(middle.y(), 300, 1e-3);
  EXPECT_NEAR(crop.size, 2 * 1.2F * 1.6F * 60, 1e-3) << "1.2 times as far as the ankles";
}

TEST(CropAround, FollowsTheTrunkWhereLimbsAreNotSeen) {
  DetectedPose pose = StandingPerson(500, 300, 60);
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    if (j < kLShoulder || (j > kRShoulder && j < kLHip) || j > kRHip) pose.joints[j].score = 0.0F;
  }
  EXPECT_NEAR(CropAround(pose, 1280, 720).size, 2 * 1.9F * 60, 1e-3);
}

TEST(CropAround, IsNoLargerThanWhatHoldsTheImage) {
  const Crop crop = CropAround(StandingPerson(100, 100, 500), 200, 150);
  EXPECT_NEAR(crop.size, 200, 1e-3);
}

TEST(CropAround, IsNeverEmpty) { EXPECT_GT(CropAround(DetectedPose{}, 1, 1).size, 1.0F); }

/// Mean place of the bright pixels of an input.
Eigen::Vector2f BrightPlace(const std::vector<float>& input, int width) {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  float weight = 0.0F;
  for (std::size_t i = 0; i < input.size() / 3; ++i) {
    const float brightness = input[3 * i] + 1.0F;
    const auto x = static_cast<float>(i % static_cast<std::size_t>(width)) + 0.5F;
    const std::size_t row = i / static_cast<std::size_t>(width);
    const auto y = static_cast<float>(row) + 0.5F;
    sum += brightness * Eigen::Vector2f(x, y);
    weight += brightness;
  }
  return sum / weight;
}

TEST(TakeCrop, PutsPixelsWhereTheCropSays) {
  cv::Mat image(600, 800, CV_8UC3, cv::Scalar());
  cv::rectangle(image, cv::Rect(400, 200, 20, 20), cv::Scalar::all(255), cv::FILLED);  // its centre is at 410, 210
  std::vector<float> input;
  // Enlarged, about the same size, and made 2, 3 and 5 times smaller; also beyond the image's border.
  for (const float size : {60.0F, 128.0F, 300.0F, 420.0F, 700.0F, 1400.0F}) {
    const Crop crop{{410.0F - 0.4F * size, 210.0F - 0.7F * size}, size};
    TakeCrop(image, crop, 128, kScale, input);
    const Eigen::Vector2f place = BrightPlace(input, 128);
    EXPECT_NEAR(place.x(), 0.4F * 128, 0.15) << size;
    EXPECT_NEAR(place.y(), 0.7F * 128, 0.15) << size;
  }
}

TEST(TakeCrop, GivesRedGreenBlueAndBlackOutside) {
  const cv::Mat image(10, 10, CV_8UC3, cv::Scalar(0, 51, 255));  // blue, green, red
  std::vector<float> input;
  TakeCrop(image, {{-10.0F, 0.0F}, 20.0F}, 20, kScale, input);
  const float* inside = &input[3 * (5 * 20 + 15)];
  EXPECT_NEAR(inside[0], 1.0F, 1e-5);
  EXPECT_NEAR(inside[1], -0.6F, 1e-5);
  EXPECT_NEAR(inside[2], -1.0F, 1e-5);
  EXPECT_FLOAT_EQ(input[3 * (5 * 20 + 3)], -1.0F);
}

TEST(TakeWholeImage, FillsUpToMultiplesOf32) {
  cv::Mat image(1920, 1080, CV_8UC3, cv::Scalar());
  cv::rectangle(image, cv::Rect(800, 1500, 40, 40), cv::Scalar::all(255), cv::FILLED);
  std::vector<float> input;
  const WholeImage whole = TakeWholeImage(image, 512, kScale, input);
  EXPECT_EQ(whole.height, 512);
  EXPECT_EQ(whole.width, 288);
  EXPECT_EQ(input.size(), 3U * 512 * 288);
  const Eigen::Vector2f place = whole.image_pixels_per_pixel * BrightPlace(input, whole.width);
  EXPECT_NEAR(place.x(), 820, 1.5);
  EXPECT_NEAR(place.y(), 1520, 1.5);
}

}  // namespace
}  // namespace canonpose
