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

using testing::CollectedMessages;
using ::testing::ElementsAre;
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

std::vector<CameraView>& Cameras(Dataset& dataset) { return dataset.sequences.front().cameras; }

void DropTruth(Dataset& dataset) {
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      view.solved = view.truth;
      view.truth = {};
    }
  }
}

TEST_F(EvaluateDatasetsTest, ACalibrationInMetresIsReadAsSuch) {
  Dataset dataset = SmallCapture();
  DropTruth(dataset);
  const EvaluationReport right = EvaluateDatasets(Job(dataset), SolvedPoses());
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      for (Camera& camera : view.calibration) camera.camera_from_world_translation /= 1000.0;
    }
  }
  const CollectedMessages messages;
  const EvaluationReport report = EvaluateDatasets(Job(dataset), SolvedPoses());
  EXPECT_THAT(messages.text(), HasSubstr("the calibration's t is in metres"));
  EXPECT_NEAR(report.metrics.n_mpjpe_mm, right.metrics.n_mpjpe_mm, 0.1);
}

TEST_F(EvaluateDatasetsTest, TheTimeShiftThatSolveFoundIsUsed) {
  Dataset dataset = SmallCapture();
  dataset.sequences.resize(1);
  DropTruth(dataset);
  // Camera 1 began three frames early: its frame n shows what the others show in frame n - 3.
  constexpr int kEarly = 3;
  Sequence& sequence = dataset.sequences.front();
  CameraView& view = Cameras(dataset)[1];
  const std::size_t joints = dataset.skeleton.joints.size();
  const CameraView recorded = view;
  for (std::size_t t = static_cast<std::size_t>(sequence.frame_count); t-- > kEarly;) {
    std::copy_n(&recorded.keypoints[2 * joints * (t - kEarly)], 2 * joints, &view.keypoints[2 * joints * t]);
    std::copy_n(&recorded.confidence[joints * (t - kEarly)], joints, &view.confidence[joints * t]);
    view.solved.PoseAt(static_cast<int>(t)) = recorded.solved.PoseAt(static_cast<int>(t) - kEarly);
  }
  const EvaluationReport late = EvaluateDatasets(Job(dataset), SolvedPoses());
  view.time_offset_seconds = -kEarly / sequence.fps;
  const EvaluationReport shifted = EvaluateDatasets(Job(dataset), SolvedPoses());
  ASSERT_TRUE(shifted.reference.reprojection_px && late.reference.reprojection_px);
  EXPECT_GT(late.reference.reprojection_px->median_px, 0.5);
  EXPECT_LT(shifted.reference.reprojection_px->median_px, 0.1);
  EXPECT_LT(shifted.metrics.n_mpjpe_mm, 0.5 * late.metrics.n_mpjpe_mm);
}

TEST_F(EvaluateDatasetsTest, TruthInMetresIsReadAsSuch) {
  Dataset dataset = SmallCapture();
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      view.solved = view.truth;
      for (std::size_t i = 0; i < view.solved.positions().size(); i += 7) view.solved.positions()[i] += 100.0F;
      for (float& value : view.truth.positions()) value /= 1000.0F;
    }
  }
  const CollectedMessages messages;
  const EvaluationReport report = EvaluateDatasets(Job(dataset), SolvedPoses());
  EXPECT_THAT(messages.text(), HasSubstr("the truth is in metres"));
  EXPECT_GT(report.metrics.n_mpjpe_mm, 5.0);
}

TEST_F(EvaluateDatasetsTest, InterchangedCamerasAreRefusedAndNamed) {
  Dataset dataset = SmallCapture();
  DropTruth(dataset);
  for (Sequence& sequence : dataset.sequences) {
    std::swap(sequence.cameras[0].calibration, sequence.cameras[2].calibration);
  }
  const std::string names = Cameras(dataset)[0].name + " and " + Cameras(dataset)[2].name + " interchanged";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateDatasets(Job(dataset), SolvedPoses()); }), HasSubstr(names));
}

TEST_F(EvaluateDatasetsTest, TruthInAnotherFrameIsRefused) {
  Dataset dataset = SmallCapture();
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      std::vector<float>& truth = view.truth.positions();
      for (std::size_t i = 0; i < truth.size(); i += 3) {
        truth[i + 1] *= -1.0F;
        truth[i + 2] *= -1.0F;
      }
    }
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateDatasets(Job(dataset), PerfectPoses()); }),
              AllOf(HasSubstr("/truth"), HasSubstr("rotated by 1")));
}

TEST_F(EvaluateDatasetsTest, ABenchmarksProtocolOnOtherDataIsWarnedOf) {
  Dataset dataset = SmallCapture();
  dataset.source.format = "simulated";
  DatasetEvaluation job = Job(dataset);
  job.protocol = FindProtocol("skipose");
  EXPECT_THAT(EvaluateDatasets(job, PerfectPoses()).warnings,
              ElementsAre(AllOf(HasSubstr("the protocol of Ski-PosePTZ"), HasSubstr("simulated"))));
}

TEST_F(EvaluateDatasetsTest, CanonicalPosesOfWhichNoneCanBeUsedAreLeftOut) {
  DatasetEvaluation job = Job(SmallCapture());
  job.canonical = true;
  Predictor predictor;
  predictor.check = [](const Dataset&, const std::string&) {};
  predictor.predict = [](const Sequence& sequence, std::size_t camera) {
    PredictedPoses poses{sequence.cameras[camera].truth, sequence.cameras[camera].truth};
    for (float& value : poses.pose_in_camera.positions()) value *= -1.0F;  // every pose points away from its truth
    return poses;
  };
  const EvaluationReport report = EvaluateDatasets(job, predictor);
  EXPECT_FALSE(report.canonical.has_value());
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("canonical poses are not compared")));
}

TEST_F(EvaluateDatasetsTest, AProtocolsSubjectsMustBeThere) {
  DatasetEvaluation job = Job(SmallCapture());
  job.protocol = FindProtocol("h36m-1");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateDatasets(job, PerfectPoses()); }),
              AllOf(HasSubstr("S9"), HasSubstr("`protocol=")));
}

}  // namespace
}  // namespace canonpose
