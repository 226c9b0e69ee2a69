#include "canonpose/detect/appearance.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

TEST(Appearance, IsTheColourOfTrunkAndThighs) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(255, 255, 255));
  const DetectedPose pose = testing::StandingPerson(300, 240, 80);
  cv::rectangle(image, cv::Rect(260, 150, 80, 90), cv::Scalar(0, 0, 255), cv::FILLED);  // a red shirt
  cv::rectangle(image, cv::Rect(270, 240, 60, 80), cv::Scalar(255, 0, 0), cv::FILLED);  // blue trousers
  const Appearance seen = MeasureAppearance(image, pose);
  EXPECT_NEAR(seen[0], 1.0F, 0.05);
  EXPECT_NEAR(seen[2], 0.0F, 0.05);
  EXPECT_NEAR(seen[3], 0.0F, 0.05);
  EXPECT_NEAR(seen[5], 1.0F, 0.05);
}

TEST(Appearance, IsUnknownWhereThePersonIsNotSeen) {
  const cv::Mat image(480, 640, CV_8UC3, cv::Scalar());
  DetectedPose pose = testing::StandingPerson(300, 240, 80);
  pose.joints[kLHip].score = 0.0F;
  const Appearance seen = MeasureAppearance(image, pose);
  EXPECT_TRUE(std::isnan(seen[0]));
  EXPECT_FALSE(std::isnan(seen[3])) << "the other thigh";
  EXPECT_TRUE(std::isnan(MeasureAppearance(image, testing::StandingPerson(-900, 240, 80))[0])) << "outside";
}

TEST(Appearance, ComparesWhatBothHave) {
  const float nan = std::nanf("");
  const Appearance a{1, 0, 0, nan, nan, nan};
  Appearance b{0.5F, 0, 0.25F, 0, 1, 0};
  EXPECT_FLOAT_EQ(AppearanceDistance(a, b, 9.0F), 0.25F);
  EXPECT_FLOAT_EQ(AppearanceDistance(a, {nan, nan, nan, 1, 1, 1}, 9.0F), 9.0F);
  UpdateAppearance(b, {1.5F, nan, nan, nan, nan, nan}, 0.5F);
  EXPECT_FLOAT_EQ(b[0], 1.0F);
  EXPECT_FLOAT_EQ(b[4], 1.0F);
}

}  // namespace
}  // namespace canonpose
