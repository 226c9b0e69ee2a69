#include "canonpose/pipeline/evaluate_datasets.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

Dataset SmallCapture() {
  SimulationOptions options = testing::SmallSimulation();
  options.seconds = 2.0;
  options.detector.noise = 0.0;
  return testing::Simulate(options).dataset;
}

/// Predicts the truth, twice as large.
Predictor PerfectPoses() {
  return {[](const Dataset&, const std::string&) {},
          [](const Sequence& sequence, std::size_t camera) {
            PredictedPoses poses{sequence.cameras[camera].truth, {}};
            for (float& value : poses.pose_in_camera.positions()) value *= 2.0F;
            return poses;
          }};
}

class EvaluateDatasetsTest : public ::testing::Test {
 protected:
  DatasetEvaluation Job(const Dataset& dataset) {
    WriteDataset(folder_ / "data.h5", dataset);
    DatasetEvaluation job;
    job.files = {folder_ / "data.h5"};
    job.protocol = FindProtocol(kAllFrames);
    return job;
  }

  TemporaryFolder folder_;
};

TEST_F(EvaluateDatasetsTest, PerfectPosesOfAnySizeHaveNoError) {
  const Dataset dataset = SmallCapture();
  const EvaluationReport report = EvaluateDatasets(Job(dataset), PerfectPoses());
  EXPECT_NEAR(report.metrics.n_mpjpe_mm, 0.0, 0.01);
  EXPECT_NEAR(report.metrics.p_mpjpe_mm, 0.0, 0.01);
  std::int64_t frames = 0;
  for (const Sequence& sequence : dataset.sequences) {
    frames += sequence.frame_count * static_cast<std::int64_t>(sequence.cameras.size());
  }
  EXPECT_EQ(report.metrics.poses, frames);
}

TEST_F(EvaluateDatasetsTest, ExactKeypointsTriangulateToTheTruth) {
  const EvaluationReport report = EvaluateDatasets(Job(SmallCapture()), TriangulatedPoses());
  EXPECT_LT(report.metrics.n_mpjpe_mm, 0.5);
}

TEST_F(EvaluateDatasetsTest, AViewWithoutPredictionsCountsAsMissing) {
  Predictor predictor = PerfectPoses();
  predictor.predict = [perfect = predictor.predict](const Sequence& sequence, std::size_t camera) {
    return camera == 0 ? PredictedPoses{} : perfect(sequence, camera);
  };
  const Dataset dataset = SmallCapture();
  const EvaluationReport report = EvaluateDatasets(Job(dataset), predictor);
  std::int64_t frames = 0;
  for (const Sequence& sequence : dataset.sequences) frames += sequence.frame_count;
  EXPECT_EQ(report.missing_predictions, frames);
}

TEST_F(EvaluateDatasetsTest, RefusesDatasetsThatAreNotSolved) {
  const DatasetEvaluation job = Job(SmallCapture());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateDatasets(job, SolvedPoses()); }),
              HasSubstr("expected solved poses"));
}

TEST_F(EvaluateDatasetsTest, AProtocolsSubjectsMustBeThere) {
  DatasetEvaluation job = Job(SmallCapture());
  job.protocol = FindProtocol("h36m-1");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateDatasets(job, PerfectPoses()); }),
              AllOf(HasSubstr("S9"), HasSubstr("`protocol=")));
}

}  // namespace
}  // namespace canonpose
