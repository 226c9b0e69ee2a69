#include "canonpose/simulate/statistics.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/simulate/figure_testing.h"

namespace canonpose {
namespace {

using testing::WalkInCircle;

const DetectorLayout& Human36m() {
  static const DetectorLayout layout = MakeDetectorLayout(*FindSkeleton("h36m-17"));
  return layout;
}

DetectorStatistics Collect(const std::string& kind, const DetectorOptions& options, int clips = 6) {
  RigOptions rig_options;
  rig_options.kind = kind;
  DetectorStatistics statistics(Human36m());
  std::uint64_t number = 0;
  for (int clip = 0; clip < clips; ++clip) {
    const auto seed = static_cast<std::uint64_t>(clip);
    const LandmarkTrack track = WalkInCircle(1500, 50.0);
    for (const FilmingCamera& camera : MakeRig(rig_options, Rng(seed))->Film(track, Rng(seed, {1}))) {
      statistics.Add(track, camera, Detect(track, camera, Human36m(), options, 1, Rng(seed, {2, number++})));
    }
  }
  return statistics;
}

class DefaultDetector : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Rigs, DefaultDetector, ::testing::Values("studio", "ptz"));

TEST_P(DefaultDetector, IsAsGoodAndAsBadAsRealDetectors) {
  const DetectorStatistics statistics = Collect(GetParam(), DetectorOptions{});
  RecordProperty("table", statistics.Describe());
  const auto median = [&](Landmark joint) { return statistics.Percentile(joint, 50); };
  EXPECT_GT(statistics.Percentile(-1, 50), 1.0);
  EXPECT_LT(statistics.Percentile(-1, 50), 1.5);
  EXPECT_GT(statistics.Percentile(-1, 95), 4.5);
  EXPECT_LT(statistics.Percentile(-1, 95), 8.0);
  EXPECT_GT(statistics.Percentile(-1, 99), 10.0) << "heavy tails";
  const double hips = (median(kRHip) + median(kLHip)) / 2;
  for (const Landmark joint : {kRWrist, kLWrist, kRFoot, kLFoot}) {
    EXPECT_GT(median(joint) / hips, 1.3);
    EXPECT_LT(median(joint) / hips, 2.2);
  }
  EXPECT_GT(statistics.ConfidenceAuc(), 0.7);
  EXPECT_LT(statistics.ConfidenceAuc(), 0.82);
  EXPECT_LT(statistics.ConfidenceCorrelation(), -0.3);
  EXPECT_GT(statistics.ConfidenceCorrelation(), -0.52);
  EXPECT_NEAR(statistics.ConfidencePercentile(50), 0.8, 0.05);
  EXPECT_NEAR(statistics.Share(kSwapped), 0.010, 0.006);
  EXPECT_NEAR(statistics.Share(kOutlier), 0.010, 0.005);
  EXPECT_NEAR(statistics.Share(kMissed), 0.015, 0.006);
  EXPECT_NEAR(statistics.MissedFrameShare(), 0.006, 0.004);
  EXPECT_GT(statistics.HiddenPercentile(50), 1.5 * statistics.Percentile(-1, 50));
  EXPECT_LT(statistics.HiddenPercentile(50), 4.0 * statistics.Percentile(-1, 50));
  EXPECT_GT(statistics.Share(kOccluded), 0.08);
  EXPECT_LT(statistics.Share(kOccluded), 0.25);
}

TEST(DetectorStatistics, FindsNoErrorsWhereThereAreNone) {
  DetectorOptions exact;
  exact.noise = 0.0;
  const DetectorStatistics statistics = Collect("studio", exact, 1);
  EXPECT_LT(statistics.Percentile(-1, 100), 0.03);
  EXPECT_GT(statistics.ConfidencePercentile(1), 0.99);
  EXPECT_TRUE(std::isnan(statistics.ConfidenceAuc()));
  EXPECT_EQ(statistics.Share(kMissed), 0.0);
  EXPECT_EQ(statistics.MissedFrameShare(), 0.0);
}

TEST(DetectorStatistics, SeesThatConfidencesReflectErrorsPerfectly) {
  DetectorOptions options;
  options.confidence = 0.0;
  const DetectorStatistics perfect = Collect("studio", options, 2);
  EXPECT_GT(perfect.ConfidenceAuc(), 0.99);
  EXPECT_LT(perfect.ConfidenceCorrelation(), -0.98);
  options.confidence = 4.0;
  const DetectorStatistics useless = Collect("studio", options, 2);
  EXPECT_LT(useless.ConfidenceAuc(), 0.66);
  EXPECT_GT(useless.ConfidenceAuc(), 0.5);
}

TEST(DetectorStatistics, MeasuresKnownErrors) {
  LandmarkTrack track{"still", "figure", 50.0, {}};
  constexpr int kFrames = 100;
  const auto figure = testing::StandingFigure();
  for (int t = 0; t < kFrames; ++t) track.positions_mm.insert(track.positions_mm.end(), figure.begin(), figure.end());
  RigOptions rig_options;
  const FilmingCamera camera = MakeRig(rig_options, Rng(1))->Film(track, Rng(1))[0];
  DetectorOptions exact;
  exact.noise = 0.0;
  Detections detections = Detect(track, camera, Human36m(), exact, 1, Rng(1));
  const double height = ImageHeightPx(camera.cameras[0], figure.data());
  for (std::size_t t = 0; t < kFrames; ++t) {
    for (std::size_t j = 0; j < 17; ++j) {
      const std::size_t at = 17 * t + j;
      // Joint j of frame t is (t / 10) % of the height too far to the right; the confidence falls accordingly.
      detections.keypoints[2 * at] += static_cast<float>(height * static_cast<double>(t) / 1000.0);
      detections.confidence[at] = 1.0F - static_cast<float>(t) / 200.0F;
    }
  }
  detections.errors[3] = kSwapped | kOutlier;
  for (std::size_t j = 0; j < 17; ++j) {
    detections.confidence[17 * 99 + j] = 0.0F;
    detections.errors[17 * 99 + j] = kMissed;
  }
  DetectorStatistics statistics(Human36m());
  statistics.Add(track, camera, detections);
  EXPECT_NEAR(statistics.Percentile(kRKnee, 50), 4.9, 0.06);
  EXPECT_NEAR(statistics.Percentile(-1, 90), 8.85, 0.1);
  // Errors of exactly 5 % fall on either side, by rounding.
  EXPECT_NEAR(statistics.ConfidenceAuc(), 1.0, 1e-3);
  EXPECT_NEAR(statistics.ConfidenceCorrelation(), -1.0, 0.01);
  EXPECT_DOUBLE_EQ(statistics.Share(kSwapped), 1.0 / (99 * 17));
  EXPECT_DOUBLE_EQ(statistics.Share(kOutlier), 1.0 / (99 * 17));
  EXPECT_EQ(statistics.Share(kMissed), 0.0) << "a missed frame is counted as one, not as joints";
  EXPECT_DOUBLE_EQ(statistics.MissedFrameShare(), 0.01);

  DetectorStatistics twice(Human36m());
  twice.Merge(statistics);
  twice.Merge(statistics);
  EXPECT_EQ(twice.Describe(), statistics.Describe());
}

TEST(DetectorStatistics, DescribesItselfInATable) {
  const std::string text = Collect("ptz", DetectorOptions{}, 1).Describe();
  for (const char* word : {"percentile", "RWrist", "all", "hidden", "swap", "missed", "confidence AUC", "Spearman"}) {
    EXPECT_THAT(text, ::testing::HasSubstr(word));
  }
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

}  // namespace
}  // namespace canonpose
