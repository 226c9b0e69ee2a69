#include "canonpose/train/trainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <numbers>
#include <sstream>
#include <thread>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/mirror.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::ErrorOf;
using testing::TemporaryFolder;

constexpr int kJoints = 5;

Skeleton FiveJoints() { return {"", {"root", "a", "b", "left", "right"}, {-1, 0, 1, 0, 0}, 0, {0, 1, 2, 4, 3}}; }

/// A body of five joints that swings about, seen by cameras around it with strong perspective.
Dataset SwingingBody(int frames, int cameras, std::uint64_t seed = 1) {
  Rng rng(seed);
  Dataset dataset;
  dataset.skeleton = FiveJoints();
  Sequence sequence{"swing", "s", 30.0, true, "s", frames, {}};
  for (int c = 0; c < cameras; ++c) {
    CameraView view;
    view.name = "cam" + std::to_string(c);
    view.image_size = {1000, 1000};
    const double azimuth = 0.3 + 1.1 * c;
    const double tilt = 0.3 * (c % 2 == 0 ? 1 : -1);
    for (int t = 0; t < frames; ++t) {
      const double time = 0.13 * t;
      const double turn = 2.0 * std::sin(0.31 * time);
      const double body[kJoints][3] = {{0, 0, 0},
                                       {0.1 * std::sin(time), -0.5, 0.1},
                                       {0.4 * std::sin(time), -0.9, 0.3 * std::cos(1.3 * time)},
                                       {-0.3, 0.5 + 0.2 * std::sin(1.7 * time), 0.3 * std::cos(time)},
                                       {0.35, 0.6, -0.3 * std::sin(2.1 * time)}};
      for (const auto& joint : body) {
        const double x0 = std::cos(turn + azimuth) * joint[0] + std::sin(turn + azimuth) * joint[2];
        const double z0 = -std::sin(turn + azimuth) * joint[0] + std::cos(turn + azimuth) * joint[2];
        const double y = std::cos(tilt) * joint[1] - std::sin(tilt) * z0;
        const double z = 2.0 + std::sin(tilt) * joint[1] + std::cos(tilt) * z0;
        view.keypoints.push_back(static_cast<float>(500 + 800 * x0 / z + 0.3 * rng.Normal()));
        view.keypoints.push_back(static_cast<float>(500 + 800 * y / z + 0.3 * rng.Normal()));
        view.confidence.push_back(0.9F);
        view.truth.insert(view.truth.end(), {static_cast<float>(x0), static_cast<float>(y), static_cast<float>(z)});
      }
    }
    sequence.cameras.push_back(view);
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

TrainJob Job(const TemporaryFolder& folder, const std::string& name, const std::string& preset = "plus") {
  TrainJob job;
  job.datasets = {SwingingBody(40, 3)};
  job.data_files = {"swing.h5"};
  job.options = PresetOptions(preset);
  job.options.width = 16;
  job.options.epochs = 20;
  job.options.batch_frames = 8;
  job.options.threads = 1;
  job.options.seed = 3;
  job.run_folder = folder / name;
  return job;
}

TEST(MakeTrainingSplit, HoldsOutTheEndOfEveryStretchAndLeavesOutLoneViews) {
  Dataset dataset = SwingingBody(100, 3);
  CameraView& first = dataset.sequences[0].cameras[0];
  CameraView& second = dataset.sequences[0].cameras[1];
  for (int t : {7, 8}) first.confidence[static_cast<std::size_t>(t * kJoints)] = 0.0F;  // the root: a missing view
  second.confidence[7 * kJoints] = 0.0F;
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.1);
  EXPECT_EQ(split.validation.frames.size(), 10U);
  EXPECT_EQ(split.training.frames.size(), 89U);
  EXPECT_EQ(split.frames_without_pairs, 1);
  EXPECT_EQ(split.training.row_count(), 89 * 3 - 1);
  EXPECT_EQ(split.training.frames[7].views.size(), 2U);  // frame 8
  EXPECT_EQ(split.training.frames[7].views[0].camera, 1);
}

TEST(MakeTrainingSplit, CapturesOfDifferentFilesDoNotShareCameras) {
  const TrainingSplit split = MakeTrainingSplit({SwingingBody(10, 2), SwingingBody(10, 2)}, 0.0);
  EXPECT_EQ(split.training.static_captures.size(), 2U);
  EXPECT_NE(split.training.frames.front().capture, split.training.frames.back().capture);
}

TEST(Train, SameSeedSameBitsAndAnotherSeedOthers) {
  const TemporaryFolder folder;
  Train(Job(folder, "a"));
  Train(Job(folder, "b"));
  EXPECT_EQ(ReadFile(folder / "a/model.cpm"), ReadFile(folder / "b/model.cpm"));
  TrainJob other = Job(folder, "c");
  other.options.seed = 4;
  Train(other);
  EXPECT_NE(ReadFile(folder / "a/model.cpm"), ReadFile(folder / "c/model.cpm"));
}

TEST(Train, InterruptedAndResumedGivesTheSameBitsAndMetrics) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "whole");
  job.options.epochs = 60;
  Train(job);
  job.run_folder = folder / "pieces";
  job.options.checkpoint_seconds = 0.01;
  int interruptions = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    std::thread interrupter([attempt] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20 + 7 * attempt));
      std::raise(SIGTERM);
    });
    // A signal that comes after training has ended must not end the test.
    const auto before = std::signal(SIGTERM, SIG_IGN);
    const TrainReport report = Train(job);
    interrupter.join();
    std::signal(SIGTERM, before);
    job.resume = true;
    if (report.interrupted_by == 0) break;
    ++interruptions;
  }
  EXPECT_GE(interruptions, 1);
  const ModelFile whole = ReadModelFile(folder / "whole");
  const ModelFile pieces = ReadModelFile(folder / "pieces");
  for (const auto& [name, array] : whole.parameters) EXPECT_EQ(array.values, pieces.parameters.at(name).values) << name;
  EXPECT_EQ(whole.info.perspective, pieces.info.perspective);
  const auto lines = [](const std::filesystem::path& path) {
    std::istringstream stream(ReadFile(path));
    std::vector<std::string> result;
    for (std::string line; std::getline(stream, line);) result.push_back(line.substr(0, line.find("\"seconds\"")));
    return result;
  };
  EXPECT_EQ(lines(folder / "whole/metrics.jsonl"), lines(folder / "pieces/metrics.jsonl"));
}

TEST(Train, LearnsTheBodyWithTheRightSideInFrontForEverySeed) {
  int flipped = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const TemporaryFolder folder;
    TrainJob job = Job(folder, "run");
    job.datasets = {SwingingBody(150, 4)};
    job.options.seed = seed;
    job.options.width = 64;
    job.options.epochs = 150;
    job.options.batch_frames = 32;
    job.options.learning_rate = 2e-3;
    const TrainReport report = Train(job);
    flipped += report.model.mirror.decision == "flipped" ? 1 : 0;
    EXPECT_NE(report.model.mirror.decision, "undecided") << seed;

    const ModelFile model = ReadModelFile(job.run_folder);
    Lifter lifter = MakeLifter(model, "model.cpm", torch::kCPU);
    TrainingSplit split = MakeTrainingSplit(job.datasets, 0.0);
    const PerspectiveSlope slope = MeasurePerspectiveSlope(lifter, split.training, 0, torch::kCPU);
    EXPECT_TRUE(slope.is_sure() && !slope.is_mirrored()) << seed << ": " << slope.Describe();

    // Against the truth: predicted depths must go with the true ones, not against them.
    const torch::NoGradGuard no_grad;
    std::vector<const TrainingFrame*> frames;
    for (const TrainingFrame& frame : split.training.frames) frames.push_back(&frame);
    const BatchTensors batch = GatherBatch(split.training, frames, torch::kCPU);
    const LifterOutput output = lifter->forward(LifterInput(batch));
    const torch::Tensor depth = torch::bmm(output.rotation, output.pose).select(1, 2);  // (R, J), frames then cameras
    double covariance = 0.0;
    double predicted_squares = 0.0;
    double true_squares = 0.0;
    const std::vector<CameraView>& cameras = job.datasets[0].sequences[0].cameras;
    for (std::int64_t row = 0; row < depth.size(0); ++row) {
      const CameraView& view = cameras[static_cast<std::size_t>(row % 4)];
      for (std::int64_t j = 1; j < kJoints; ++j) {
        const auto base = static_cast<std::size_t>(row / 4) * kJoints;
        const double truth = view.truth[(base + static_cast<std::size_t>(j)) * 3 + 2] - view.truth[base * 3 + 2];
        const double predicted = depth[row][j].item<double>() - depth[row][0].item<double>();
        covariance += truth * predicted;
        predicted_squares += predicted * predicted;
        true_squares += truth * truth;
      }
    }
    EXPECT_GT(covariance / std::sqrt(predicted_squares * true_squares), 0.8) << seed;
  }
  RecordProperty("flipped", flipped);
}

TEST(Train, MirrorByRequestIsTheExactMirror) {
  const TemporaryFolder folder;
  TrainJob keep = Job(folder, "keep", "paper");
  keep.options.mirror = "keep";
  TrainJob flip = Job(folder, "flip", "paper");
  flip.options.mirror = "flip";
  EXPECT_EQ(Train(keep).model.mirror.decision, "kept by request");
  EXPECT_EQ(Train(flip).model.mirror.decision, "flipped by request");
  Lifter kept = MakeLifter(ReadModelFile(folder / "keep"), "", torch::kCPU);
  const Lifter flipped = MakeLifter(ReadModelFile(folder / "flip"), "", torch::kCPU);
  kept->Mirror();
  for (const auto& item : kept->named_parameters()) {
    EXPECT_TRUE(torch::equal(item.value(), flipped->named_parameters()[item.key()])) << item.key();
  }
}

TEST(Train, LossThatIsNoNumberStopsWithTheLastGoodModelKept) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.learning_rate = 1e30;
  EXPECT_THAT(ErrorOf(ExitCode::kComputation, [&] { Train(job); }), AllOf(HasSubstr("nan"), HasSubstr("learning_rate")));
  for (const auto& [name, array] : ReadModelFile(job.run_folder).parameters) {
    for (const float value : array.values) ASSERT_TRUE(std::isfinite(value)) << name;
  }
}

TEST(Train, RefusesToReplaceARunUnlessAsked) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  EXPECT_THAT(ErrorOf(ExitCode::kUsage, [&] { Train(job); }), HasSubstr("--resume"));
  job.overwrite = true;
  Train(job);
}

TEST(Train, ResumingWithOtherDataIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  job.resume = true;
  job.datasets = {SwingingBody(40, 3, /*seed=*/9)};
  EXPECT_THAT(ErrorOf(ExitCode::kBadInput, [&] { Train(job); }), HasSubstr("fingerprint"));
}

TEST(Train, DamagedCheckpointIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  const std::string whole = ReadFile(job.run_folder / "checkpoint.h5");
  WriteFileAtomically(job.run_folder / "checkpoint.h5", whole.substr(0, whole.size() / 2));
  job.resume = true;
  EXPECT_THAT(ErrorOf(ExitCode::kBadInput, [&] { Train(job); }), HasSubstr("checkpoint.h5"));
}

TEST(Train, FullDiskKeepsTheLastCheckpoint) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 2;
  Train(job);
  const std::string checkpoint = ReadFile(job.run_folder / "checkpoint.h5");
  job.resume = true;
  ASSERT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const rlimit limit{4096, unlimited.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string message = ErrorOf(ExitCode::kBadInput, [&] { Train(job); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  EXPECT_THAT(message, HasSubstr("free some space"));
  EXPECT_EQ(ReadFile(job.run_folder / "checkpoint.h5"), checkpoint);
}

TEST(Train, OneCameraIsNotEnough) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.datasets = {SwingingBody(40, 1)};
  EXPECT_THAT(ErrorOf(ExitCode::kComputation, [&] { Train(job); }), HasSubstr("two cameras"));
}

}  // namespace
}  // namespace canonpose
