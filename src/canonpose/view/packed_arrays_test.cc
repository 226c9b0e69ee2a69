#include "canonpose/view/packed_arrays.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/view/page_testing.h"

namespace canonpose {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Packs and unpacks, and expects every value within half a step and every gap where it was.
void ExpectRoundTrip(const std::vector<float>& values, int channels, double step) {
  PackedArrays arrays;
  arrays.Add(std::vector<float>{1.0F, 2.0F, 3.0F}, 1, {1.0});  // so that the array does not begin at byte 0
  const auto description = arrays.Add(values, channels, {step});
  const std::vector<float> read = Unpack(arrays.bytes(), description);
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(std::isnan(read[i]), std::isnan(values[i])) << i;
    if (std::isnan(values[i])) continue;
    ASSERT_NEAR(read[i], values[i], 0.5001 * step + 1e-6 * std::abs(values[i])) << i;
  }
}

TEST(PackedArrays, KeepsValuesToHalfAStepAndGapsWhereTheyAre) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0F, 3.0F);
  std::vector<float> values;
  for (int t = 0; t < 500; ++t) {
    for (int c = 0; c < 3; ++c) {
      const float value = 100.0F * std::sin(0.05F * static_cast<float>(t + 40 * c)) + noise(random);
      values.push_back((t * 3 + c) % 7 == 0 || (t > 100 && t < 150) ? kNaN : value);
    }
  }
  ExpectRoundTrip(values, 3, 0.01);
}

TEST(PackedArrays, KeepsMotionThatIsPredictedByALine) {
  std::vector<float> values;
  for (int t = 0; t < 200; ++t) values.push_back(1e-3F * static_cast<float>(t * t));
  PackedArrays arrays;
  EXPECT_EQ(arrays.Add(values, 1, {0.001})["order"], 2);
  ExpectRoundTrip(values, 1, 0.001);
}

TEST(PackedArrays, KeepsNoiseThatNothingPredicts) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> anything(-1.0F, 1.0F);
  std::vector<float> values(2000);
  for (float& value : values) value = anything(random);
  ExpectRoundTrip(values, 2, 2.0 / 65000.0);  // differences up to the whole range of 16 bits, either way
}

TEST(PackedArrays, TakesLargerStepsWhereTheRangeIsLarge) {
  const std::vector<float> values = {0.0F, 1.0F, 1e6F};
  PackedArrays arrays;
  const auto description = arrays.Add(values, 1, {1e-6});
  const double step = description["step"][0];
  EXPECT_NEAR(step, 1e6 / 65000.0, 1e-3);
  EXPECT_NEAR(Unpack(arrays.bytes(), description)[2], 1e6, step);
}

TEST(PackedArrays, KeepsTheRatioOfPositiveValues) {
  const std::vector<float> values = {0.001F, 5.0F, kNaN, 0.0F, 700.0F};
  PackedArrays arrays;
  const std::vector<float> read = Unpack(arrays.bytes(), arrays.Add(values, 1, {0.125, true}));
  for (const std::size_t i : {0U, 1U, 4U}) EXPECT_NEAR(read[i] / values[i], 1.0, 0.05) << i;
  EXPECT_TRUE(std::isnan(read[2]));
  EXPECT_TRUE(std::isnan(read[3]));  // zero has no logarithm
}

TEST(PackedArrays, KeepsAChannelWithoutAnyValue) { ExpectRoundTrip({kNaN, 1.0F, kNaN, 2.0F}, 2, 0.5); }

TEST(PackedArrays, OfSmoothMotionTakeFewBytes) {
  std::vector<float> values;
  for (int t = 0; t < 5000; ++t) values.push_back(1000.0F * std::sin(0.01F * static_cast<float>(t)));
  PackedArrays arrays;
  arrays.Add(values, 1, {0.2});
  EXPECT_LT(Gzip(arrays.bytes()).size(), values.size() / 2);
}

TEST(Base64, IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(Gzip, IsReadByZlib) {
  std::string bytes;
  for (int i = 0; i < 300000; ++i) bytes.push_back(static_cast<char>(i % 251 * (i % 251) % 251));
  EXPECT_EQ(testing::Gunzip(Gzip(bytes)), bytes);
  EXPECT_EQ(testing::Gunzip(testing::FromBase64(Base64(Gzip(bytes)))), bytes);
}

}  // namespace
}  // namespace canonpose
