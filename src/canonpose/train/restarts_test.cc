#include "canonpose/train/restarts.h"

#include <chrono>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/train/puppet_testing.h"
#include "canonpose/train/trainer.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::StoppedAfter;
using testing::TemporaryFolder;

/// Random bodies of five joints, seen by three cameras from all around.
Dataset Tumbling(int frames) {
  Rng rng(1);
  Dataset dataset;
  dataset.skeleton = {"", {"pelvis", "left hip", "right hip", "head", "chest"}, {-1, 0, 0, 4, 0}, 0, {0, 2, 1, 3, 4}};
  Sequence sequence{"tumbling", "s", 30.0, true, "s", frames, {}};
  for (int c = 0; c < 3; ++c) {
    CameraView view;
    view.name = "cam" + std::to_string(c);
    view.image_size = {1000, 1000};
    sequence.cameras.push_back(view);
  }
  for (int t = 0; t < frames; ++t) {
    for (int j = 0; j < 5; ++j) {
      const double body[] = {rng.Normal(), rng.Normal(), rng.Normal()};
      for (int c = 0; c < 3; ++c) {
        CameraView& view = sequence.cameras[static_cast<std::size_t>(c)];
        const double x = std::cos(1.2 * c) * body[0] + std::sin(1.2 * c) * body[2];
        view.keypoints.push_back(static_cast<float>(500 + 80 * x));
        view.keypoints.push_back(static_cast<float>(500 + 80 * body[1]));
        view.confidence.push_back(0.9F);
      }
    }
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

TrainJob RestartJob(const TemporaryFolder& folder, const std::string& name) {
  TrainJob job;
  job.datasets = {Tumbling(60)};
  job.data_files = {"tumbling.h5"};
  job.options = PresetOptions("plus");
  job.options.width = 16;
  job.options.epochs = 12;
  job.options.batch_frames = 8;
  job.options.threads = 1;
  job.options.seed = 3;
  job.options.restarts = 4;
  job.options.restart_steps = 25;
  job.run_folder = folder / name;
  return job;
}

/// metrics.jsonl, without the times.
std::vector<nlohmann::json> Metrics(const std::filesystem::path& run) {
  std::istringstream stream(ReadFile(run / "metrics.jsonl"));
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(nlohmann::json::parse(line));
    lines.back().erase("seconds");
  }
  return lines;
}

void ExpectSameParameters(const std::filesystem::path& a, const std::filesystem::path& b) {
  const ModelFile one = ReadModelFile(a);
  const ModelFile other = ReadModelFile(b);
  for (const auto& [name, array] : one.parameters) EXPECT_EQ(array.values, other.parameters.at(name).values) << name;
  EXPECT_EQ(one.info.perspective, other.info.perspective);
  EXPECT_EQ(one.info.mirror.slope, other.info.mirror.slope);
}

TEST(BestRestart, IsTheSmallestAndTheFirstAmongEquals) {
  EXPECT_EQ(BestRestart({3.0}), 0);
  EXPECT_EQ(BestRestart({3.0, 1.0, 2.0, 1.0}), 1);
}

TEST(RestartPlan, CountsTheStepsOfAllAndNeverMoreThanTheRunHas) {
  const RestartPlan plan(3, 100, 1000);
  RestartState state;
  EXPECT_TRUE(plan.IsRunning(state));
  EXPECT_EQ(plan.StepsInAll(), 1200);
  EXPECT_EQ(plan.StepsDone(state, 40), 40);
  state = {2, {0.5, 0.4}, nullptr};
  EXPECT_EQ(plan.StepsDone(state, 40), 240);
  state = {1, {0.5, 0.4, 0.6}, nullptr};
  EXPECT_FALSE(plan.IsRunning(state));
  EXPECT_EQ(plan.StepsDone(state, 1000), 1200);
  EXPECT_EQ(RestartPlan(3, 100, 70).steps(), 70);
  EXPECT_FALSE(RestartPlan(1, 100, 1000).IsRunning({}));
}

TEST(Restarts, ContinueWithTheRunOfTheSmallestLossAsIfItWereAlone) {
  const TemporaryFolder folder;
  const TrainJob job = RestartJob(folder, "restarts");
  Train(job);
  std::vector<nlohmann::json> lines = Metrics(job.run_folder);
  ASSERT_EQ(lines.size(), 4U + 9U);  // of 12 epochs of 7 steps, three ended before step 25
  int best = 0;
  for (int r = 0; r < 4; ++r) {
    EXPECT_EQ(lines[static_cast<std::size_t>(r)]["restart"], r);
    if (lines[static_cast<std::size_t>(r)]["view"] < lines[static_cast<std::size_t>(best)]["view"]) best = r;
  }
  EXPECT_NE(best, 0);  // this seed's own start is not the best, so that something is chosen

  TrainJob alone = RestartJob(folder, "alone");
  alone.options.restarts = 1;
  alone.options.seed = RestartSeed(3, best);
  EXPECT_EQ(lines[static_cast<std::size_t>(best)]["seed"], alone.options.seed);
  Train(alone);
  ExpectSameParameters(job.run_folder, alone.run_folder);
  const std::vector<nlohmann::json> its_lines = Metrics(alone.run_folder);
  EXPECT_EQ(lines.back(), its_lines.back());
}

/// With everything else that training without labels can do.
TrainJob FullJob(const TemporaryFolder& folder, const std::string& name) {
  TrainJob job = RestartJob(folder, name);
  job.options.camera_consistency = CameraConsistency::kOff;
  job.options.ray = RayForm::kRoot;
  job.options.rotation = RotationForm::kSix;
  job.options.rotation_spread = 4.0;
  job.options.schedule = RateSchedule::kCosine;
  return job;
}

class RestartsInPieces : public ::testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Restarts, RestartsInPieces, ::testing::Values(false, true),
                         [](const auto& is_full) { return is_full.param ? "full" : "plain"; });

TEST_P(RestartsInPieces, InterruptedAndResumedGiveTheSameBitsAndMetrics) {
  const TemporaryFolder folder;
  const auto make = GetParam() ? FullJob : RestartJob;
  Train(make(folder, "whole"));
  TrainJob job = make(folder, "pieces");
  job.options.checkpoint_seconds = 0.0;
  int interrupted_restarts = 0;
  for (int attempt = 0; attempt < 200; ++attempt) {
    const TrainReport report = StoppedAfter(5 + 7 * attempt, [&] { return Train(job); });
    job.resume = true;
    if (!report.stopped) break;
    const Checkpoint checkpoint = ReadCheckpoint(job.run_folder / "checkpoint.h5");
    if (checkpoint.restarts.best) ++interrupted_restarts;
  }
  EXPECT_GE(interrupted_restarts, 1);
  ExpectSameParameters(folder / "whole", job.run_folder);
  EXPECT_EQ(Metrics(folder / "whole"), Metrics(job.run_folder));
}

TEST(Restarts, AsLongAsTheRunChooseAmongWholeRuns) {
  const TemporaryFolder folder;
  TrainJob job = RestartJob(folder, "run");
  job.options.epochs = 2;
  job.options.restart_steps = 1000;
  EXPECT_EQ(Train(job).model.info.steps, 14);
  EXPECT_EQ(Metrics(job.run_folder).size(), 4U);
}

TEST(Restarts, AreRefusedWherePosesAreLearnedFrom) {
  for (const char* preset : {"supervised", "best"}) {
    TrainOptions options = PresetOptions(preset);
    options.Validate();
    options.restarts = 2;
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("restarts")) << preset;
  }
}

}  // namespace
}  // namespace canonpose
