#include "canonpose/train/morph_trainer.h"

#include <chrono>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/model/pose_morph.h"
#include "canonpose/train/puppet_testing.h"

namespace canonpose {
namespace {

using testing::CalibratedShow;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::kJoints;
using testing::PuppetShow;
using testing::StoppedAfter;
using testing::TemporaryFolder;

/// Moves joint 2 of every pose by a tenth of the distance of joint 1 from the root: an error that depends on the pose.
void Disturb(Dataset& dataset) {
  for (CameraView& view : dataset.sequences[0].cameras) {
    for (std::size_t first = 0; first < view.confidence.size(); first += kJoints) {
      float* pose = &view.keypoints[2 * first];
      pose[4] += 0.1F * std::hypot(pose[2] - pose[0], pose[3] - pose[1]);
    }
  }
}

MorphJob Job(const TemporaryFolder& folder, const std::string& name, const Dataset& detected, const Dataset& exact) {
  MorphJob job;
  AddPairsOfDatasets(detected, "detected", exact, "exact", job.pairs);
  job.skeleton = detected.skeleton;
  job.data_files = {"detected"};
  job.data_fingerprints = {"1"};
  job.options.width = 32;
  job.options.epochs = 40;
  job.options.batch_poses = 32;
  job.options.learning_rate = 3e-3;
  job.options.threads = 1;
  job.run_folder = folder / name;
  return job;
}

Dataset Disturbed(const Dataset& exact) {
  Dataset detected = exact;
  Disturb(detected);
  return detected;
}

TEST(MorphPairs, TruthSeenByTheCamerasIsWhatADatasetOfTrueKeypointsSays) {
  const Dataset exact = CalibratedShow(20, 3);
  const Dataset detected = Disturbed(exact);
  MorphPairs of_truth;
  AddPairsOfTruth(detected, "detected", of_truth);
  MorphPairs of_datasets;
  AddPairsOfDatasets(detected, "detected", exact, "exact", of_datasets);
  ASSERT_EQ(of_truth.count(), 60U);
  EXPECT_EQ(of_truth.input, of_datasets.input);
  for (std::size_t i = 0; i < of_truth.offset.size(); ++i) {
    EXPECT_NEAR(of_truth.offset[i], of_datasets.offset[i], 3e-3) << i << ": but for the detector's noise of 0.3 px";
    const bool is_disturbed = i % (2 * kJoints) == 2;
    EXPECT_EQ(of_datasets.offset[i] != 0.0F, is_disturbed) << i;
  }
}

TEST(MorphPairs, RefuseDatasetsThatDoNotBelongTogether) {
  const Dataset detected = PuppetShow(20, 2);
  MorphPairs pairs;
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { AddPairsOfDatasets(detected, "a.h5", PuppetShow(21, 2), "b.h5", pairs); }),
      HasSubstr("20 frames"));
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { AddPairsOfDatasets(PuppetShow(20, 3), "a.h5", detected, "b.h5", pairs); }),
      HasSubstr("camera"));
  Dataset bare = detected;
  for (CameraView& view : bare.sequences[0].cameras) view.truth = {};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AddPairsOfTruth(bare, "a.h5", pairs); }), HasSubstr("`exact`"));
}

TEST(TrainMorph, TakesASystematicErrorAwayFromPosesItHasNotSeen) {
  const TemporaryFolder folder;
  const Dataset exact = PuppetShow(200, 3);
  const MorphReport report = TrainMorph(Job(folder, "run", Disturbed(exact), exact));
  EXPECT_LT(report.after_percent, 0.25 * report.before_percent);

  const PoseMorph morph = PoseMorph::Open(folder / "run");
  const Dataset other = PuppetShow(100, 3, /*seed=*/2);
  Dataset moved = Disturbed(other);
  morph.Apply(moved, "other");
  double before = 0.0;
  double after = 0.0;
  const std::vector<float>& truth = other.sequences[0].cameras[1].keypoints;
  const std::vector<float> disturbed = Disturbed(other).sequences[0].cameras[1].keypoints;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    before += std::abs(disturbed[i] - truth[i]);
    after += std::abs(moved.sequences[0].cameras[1].keypoints[i] - truth[i]);
  }
  EXPECT_LT(after, 0.4 * before);
}

TEST(TrainMorph, InterruptedAndResumedGivesTheSameBits) {
  const TemporaryFolder folder;
  const Dataset exact = PuppetShow(200, 3);
  const Dataset detected = Disturbed(exact);
  TrainMorph(Job(folder, "whole", detected, exact));
  MorphJob job = Job(folder, "pieces", detected, exact);
  int interruptions = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    const MorphReport report = StoppedAfter(5 + 7 * attempt, [&] { return TrainMorph(job); });
    job.resume = true;
    if (report.stopped) {
      ++interruptions;
    } else if (interruptions > 0) {
      break;
    } else {  // it was to stop too early or too late: once more, at a later step
      std::filesystem::remove_all(job.run_folder);
    }
  }
  EXPECT_GE(interruptions, 1);
  EXPECT_EQ(ReadFile(folder / "whole/model.cpm"), ReadFile(folder / "pieces/model.cpm"));
  EXPECT_EQ(ReadFile(folder / "whole/metrics.jsonl"), ReadFile(folder / "pieces/metrics.jsonl"));
}

TEST(TrainMorph, RefusesToResumeAnotherRun) {
  const TemporaryFolder folder;
  const Dataset exact = PuppetShow(100, 3);
  MorphJob job = Job(folder, "run", Disturbed(exact), exact);
  job.options.epochs = 1;
  TrainMorph(job);
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { TrainMorph(job); }), HasSubstr("`resume`"));
  job.resume = true;
  job.options.width = 16;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { TrainMorph(job); }), HasSubstr("same data and options"));
  MorphJob few = Job(folder, "few", PuppetShow(10, 2), PuppetShow(10, 2));
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { TrainMorph(few); }), HasSubstr("too few"));
}

}  // namespace
}  // namespace canonpose
