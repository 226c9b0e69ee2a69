#include "canonpose/solve/noise_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

/// Normal errors with a scatter that falls linearly from 1 % at confidence 0 to 0.25 % at 1; joint 1 has twice that.
std::vector<KeypointError> Errors(int count) {
  Rng rng(1);
  std::vector<KeypointError> errors;
  for (int i = 0; i < count; ++i) {
    const int joint = static_cast<int>(rng.Index(3));
    const double confidence = rng.Uniform();
    const double scatter = (joint == 1 ? 2.0 : 1.0) * (0.01 - 0.0075 * confidence);
    errors.push_back({joint, confidence, scatter * std::hypot(rng.Normal(), rng.Normal())});
  }
  return errors;
}

TEST(NoiseModel, BeforeMeasurementScatterFallsWithConfidence) {
  const NoiseModel model(0.006);
  EXPECT_DOUBLE_EQ(model.Scatter(0, 1.0), 0.006);
  EXPECT_DOUBLE_EQ(model.Scatter(5, 0.5), 0.012);
}

TEST(NoiseModel, RecoversJointsAndConfidences) {
  const NoiseModel model(Errors(20000), 3);
  EXPECT_NEAR(model.Scatter(1, 0.5) / model.Scatter(0, 0.5), 2.0, 0.15);
  EXPECT_NEAR(model.Scatter(2, 0.5) / model.Scatter(0, 0.5), 1.0, 0.1);
  for (const double confidence : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const double truth = 0.01 - 0.0075 * confidence;
    EXPECT_NEAR(model.Scatter(0, confidence), truth, 0.1 * truth) << confidence;
  }
}

TEST(NoiseModel, NeverGrowsWithConfidence) {
  const NoiseModel model(Errors(3000), 3);
  for (int i = 1; i <= 100; ++i) {
    EXPECT_LE(model.Scatter(0, 0.01 * i), model.Scatter(0, 0.01 * (i - 1))) << i;
  }
}

TEST(NoiseModel, OutliersMoveItLittle) {
  std::vector<KeypointError> errors = Errors(20000);
  const double before = NoiseModel(errors, 3).Scatter(0, 0.5);
  for (std::size_t i = 0; i < errors.size(); i += 10) errors[i].length = 1.0;
  EXPECT_NEAR(NoiseModel(errors, 3).Scatter(0, 0.5), before, 0.15 * before);
}

TEST(NoiseModel, MayKeepConfidentKeypointsFromSeemingExact) {
  std::vector<KeypointError> errors = Errors(3000);
  for (KeypointError& error : errors) error.length *= error.confidence > 0.8 ? 0.01 : 1.0;
  const NoiseModel free(errors, 3);
  const NoiseModel held(errors, 3, 0.6);
  EXPECT_LT(free.Scatter(0, 1.0), 0.3 * free.Typical());
  EXPECT_GE(held.Scatter(0, 1.0), 0.6 * 0.25 * held.Typical());
  EXPECT_GT(held.Scatter(0, 1.0), 1.5 * free.Scatter(0, 1.0));
  EXPECT_DOUBLE_EQ(held.Typical(), free.Typical());
}

TEST(NoiseModel, NeverIsZero) {
  const NoiseModel model({{0, 1.0, 0.0}, {0, 0.5, 0.0}}, 1);
  EXPECT_GT(model.Scatter(0, 1.0), 0.0);
}

}  // namespace
}  // namespace canonpose
