#include "canonpose/train/trainer.h"

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <sstream>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/checkpoint.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/mirror.h"
#include "canonpose/train/puppet_testing.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

using testing::CalibratedShow;
using testing::kJoints;
using testing::PuppetShow;
using testing::StoppedAfter;

/// A puppet that does not rotate, with calibrated cameras around it.
Dataset CalibratedRing(int frames, int cameras) {
  Dataset dataset = PuppetShow(frames, cameras);
  for (std::size_t c = 0; c < dataset.sequences[0].cameras.size(); ++c) {
    CameraView& view = dataset.sequences[0].cameras[c];
    const double azimuth = 1.1 * static_cast<double>(c);
    Camera camera;
    camera.K << 800, 0, 500, 0, 800, 500, 0, 0, 1;
    camera.camera_from_world_rotation << std::cos(azimuth), 0, std::sin(azimuth), 0, 1, 0, -std::sin(azimuth), 0,
        std::cos(azimuth);
    camera.camera_from_world_translation.z() = 3.5;
    view.calibration = {camera};
    for (std::size_t i = 0; i < view.confidence.size(); ++i) {
      const std::size_t frame = i / kJoints;
      const auto puppet = testing::PuppetAt(0.13 * static_cast<double>(frame));
      const Eigen::Vector3d point = Eigen::Vector3d::Map(puppet[i % kJoints].data());
      const Eigen::Vector3d in_camera = camera.InCamera(point);
      for (int axis = 0; axis < 3; ++axis)
        view.truth.positions()[3 * i + static_cast<std::size_t>(axis)] = static_cast<float>(in_camera[axis]);
      const Eigen::Vector2d pixel = camera.Project(point);
      for (int axis = 0; axis < 2; ++axis)
        view.keypoints[2 * i + static_cast<std::size_t>(axis)] = static_cast<float>(pixel[axis]);
    }
  }
  return dataset;
}

/// Correlation of predicted with true depths relative to the root, over all joints, frames and views: near 1 for the
/// right solution, near -1 for its mirror image.
double DepthCorrelation(LiftingNetwork& lifter, const Dataset& dataset) {
  const torch::NoGradGuard no_grad;
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0);
  std::vector<const TrainingFrame*> frames;
  for (const TrainingFrame& frame : split.training.frames) frames.push_back(&frame);
  const LifterOutput output = lifter.forward(LifterInput(GatherBatch(split.training, frames, torch::kCPU)));
  const torch::Tensor depth =
      torch::bmm(output.rotation, output.pose).select(1, 2).contiguous();  // (R, J): frames, then cameras
  const float* predictions = depth.data_ptr<float>();
  const std::vector<CameraView>& cameras = dataset.sequences[0].cameras;
  double covariance = 0.0;
  double predicted_squares = 0.0;
  double true_squares = 0.0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(depth.size(0)); ++row) {
    const float* truth = &cameras[row % cameras.size()].truth.positions()[row / cameras.size() * kJoints * 3];
    for (std::size_t j = 1; j < kJoints; ++j) {
      const double actual = truth[3 * j + 2] - truth[2];
      const double predicted = predictions[row * kJoints + j] - predictions[row * kJoints];
      covariance += actual * predicted;
      predicted_squares += predicted * predicted;
      true_squares += actual * actual;
    }
  }
  return covariance / std::sqrt(predicted_squares * true_squares);
}

TrainJob Job(const TemporaryFolder& folder, const std::string& name, const std::string& preset = "plus") {
  return testing::PuppetJob(folder.path(), name, preset);
}

TEST(MakeTrainingSplit, HoldsOutTheEndOfEveryStretchAndLeavesOutLoneViews) {
  Dataset dataset = PuppetShow(100, 3);
  CameraView& first = dataset.sequences[0].cameras[0];
  CameraView& second = dataset.sequences[0].cameras[1];
  for (int t : {7, 8}) first.confidence[static_cast<std::size_t>(t * kJoints)] = 0.0F;  // the root: a missing view
  second.confidence[7 * kJoints] = 0.0F;
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.1);
  EXPECT_EQ(split.validation.frames.size(), 10U);
  EXPECT_EQ(split.training.frames.size(), 89U);
  EXPECT_EQ(split.frames_left_out, 1);
  EXPECT_EQ(split.training.row_count(), 89 * 3 - 1);
  EXPECT_EQ(split.training.frames[7].views.size(), 2U);  // frame 8
  EXPECT_EQ(split.training.frames[7].views[0].camera, 1);
}

TEST(MakeTrainingSplit, KeepsTheRotationOfEveryRow) {
  Dataset dataset = PuppetShow(20, 3);
  for (CameraView& view : dataset.sequences[0].cameras) {  // the puppet walks through the picture
    for (std::size_t i = 0; i < view.keypoints.size(); ++i) {
      const std::size_t frame = i / (2 * kJoints);
      view.keypoints[i] += (i % 2 == 0 ? 20.0F : -8.0F) * static_cast<float>(frame);
    }
  }
  dataset.sequences[0].cameras[0].confidence[7 * kJoints] = 0.0F;  // the root: a missing view
  dataset.sequences[0].cameras[1].confidence[7 * kJoints] = 0.0F;  // and with it the frame
  EXPECT_TRUE(MakeTrainingSplit({dataset}, 0.0).training.turned_from_camera.empty());
  const TrainingSet set =
      MakeTrainingSplit({dataset}, 0.0, {TrainingTarget::kViews, {RayForm::kRoot, FocalSource::kGuess}}).training;
  ASSERT_EQ(set.row_count(), 19 * 3);
  ASSERT_EQ(set.turned_from_camera.size(), 19U * 3U);
  for (std::size_t row = 0; row < set.turned_from_camera.size(); ++row) {
    const RowSource& source = set.sources[row];
    const CameraView& view = dataset.sequences[0].cameras[static_cast<std::size_t>(source.camera)];
    const float* root = &view.keypoints[static_cast<std::size_t>(source.frame) * kJoints * 2];
    const float focal = std::hypot(1000.0F, 1000.0F);
    const Eigen::Vector3f ray = Eigen::Vector3f((root[0] - 500) / focal, (root[1] - 500) / focal, 1.0F).normalized();
    EXPECT_LT((set.turned_from_camera[row] * ray - Eigen::Vector3f::UnitZ()).norm(), 1e-5F) << row;
  }
}

TEST(MakeTrainingSplit, NamedCapturesAreSharedByFilesOthersAreNot) {
  std::vector<Dataset> datasets = {PuppetShow(10, 2), PuppetShow(10, 2)};
  EXPECT_EQ(MakeTrainingSplit(datasets, 0.0).training.static_captures.size(), 1U);
  for (Dataset& dataset : datasets) dataset.sequences[0].capture_is_named = false;
  const TrainingSplit split = MakeTrainingSplit(datasets, 0.0);
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

TEST(Train, WithoutAFolderTheModelIsReturnedAndNothingIsWritten) {
  const TemporaryFolder folder;
  const TrainReport written = Train(Job(folder, "run"));
  const ModelFile read = ReadModelFile(folder / "run");
  TrainJob job = Job(folder, "run");
  job.run_folder.clear();
  job.resume = true;  // there is nothing to resume
  const auto working_folder = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const TrainReport returned = Train(job);
  job.options.learning_rate = 1e38;
  const std::string failure = ErrorOf(ErrorKind::kComputation, [&] { Train(job); });
  std::filesystem::current_path(working_folder);
  EXPECT_THAT(failure, HasSubstr("no good model was made"));
  const auto entries = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1) << "the run with a folder";
  for (const ModelFile* model : {&written.model, &read}) {
    EXPECT_EQ(returned.model.info.steps, model->info.steps);
    EXPECT_EQ(returned.model.info.mirror.decision, model->info.mirror.decision);
    ASSERT_EQ(returned.model.parameters.size(), model->parameters.size());
    for (const auto& [name, array] : model->parameters) {
      EXPECT_EQ(returned.model.parameters.at(name).values, array.values) << name;
    }
  }
}

TEST(Train, ThePresetsNameIsOnlyRecorded) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "paper", "paper");
  job.options.epochs = 2;
  Train(job);
  job.run_folder = folder / "best";
  job.options.preset = "best";
  EXPECT_EQ(Train(job).model.info.preset, "best");
  EXPECT_EQ(ReadModelFile(folder / "paper").parameters.at("upscale.weight").values,
            ReadModelFile(folder / "best").parameters.at("upscale.weight").values);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(Job(folder, "unsolved", "best")); }),
              HasSubstr("run `canonpose solve` first"));
}

/// Learns from the truth with every option of supervised training.
TrainJob AugmentedJob(const TemporaryFolder& folder, const std::string& name) {
  TrainJob job = Job(folder, name, "best");
  job.datasets = {CalibratedShow(40, 3)};
  job.options.supervision = Supervision::kTruth;
  job.options.width = 16;
  job.options.learning_rate = 1e-3;
  job.options.rotation = RotationForm::kSix;
  job.options.focal = FocalSource::kKnown;
  job.options.schedule = RateSchedule::kCosine;
  return job;
}

/// Learns from the views of moving cameras with everything that windows can be combined with; they close before the
/// end.
TrainJob WindowedJob(const TemporaryFolder& folder, const std::string& name) {
  TrainJob job = Job(folder, name);
  job.datasets[0].sequences[0].static_cameras = false;
  job.options.camera_consistency = CameraConsistency::kWindow;
  job.options.camera_window_seconds = 0.5;
  job.options.camera_window_end = 0.8;
  job.options.rotation = RotationForm::kSix;
  job.options.rotation_spread = 4.0;
  job.options.schedule = RateSchedule::kCosine;
  return job;
}

/// Batch normalisation has statistics to keep, dropout random numbers.
TrainJob MartinezJob(const TemporaryFolder& folder, const std::string& name) {
  TrainJob job = Job(folder, name, "martinez");
  job.datasets = {PuppetShow(40, 3)};
  job.options.width = 16;
  return job;
}

class TrainInPieces : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Train, TrainInPieces, ::testing::Values("plain", "augmented", "windowed", "martinez"),
                         [](const auto& kind) { return kind.param; });

TEST_P(TrainInPieces, InterruptedAndResumedGivesTheSameBitsAndMetrics) {
  const TemporaryFolder folder;
  TrainJob job = GetParam() == "augmented"  ? AugmentedJob(folder, "whole")
                 : GetParam() == "windowed" ? WindowedJob(folder, "whole")
                 : GetParam() == "martinez" ? MartinezJob(folder, "whole")
                                            : Job(folder, "whole");
  job.options.epochs = 60;
  Train(job);
  job.run_folder = folder / "pieces";
  job.options.checkpoint_seconds = 0.01;
  int interruptions = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    const TrainReport report = StoppedAfter(5 + 7 * attempt, [&] { return Train(job); });
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

TEST(Train, LearnsTheBodyTheRightWayRoundForEverySeed) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  int flipped = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TemporaryFolder folder;
    TrainJob job = Job(folder, "run");
    job.datasets = {PuppetShow(100, 4)};
    job.options.seed = seed;
    job.options.width = 128;
    job.options.epochs = 400;
    job.options.batch_frames = 32;
    job.options.learning_rate = 2e-3;
    const TrainReport report = Train(job);
    flipped += report.model.info.mirror.decision == "flipped" ? 1 : 0;
    EXPECT_NE(report.model.info.mirror.decision, "undecided") << seed;
    EXPECT_GT(report.model.info.perspective, 0.2) << seed;
    EXPECT_EQ(report.model.info.trap.verdict, "right") << seed;

    const auto lifter = MakeLifter(ReadModelFile(job.run_folder), "model.cpm", torch::kCPU);
    EXPECT_GT(DepthCorrelation(*lifter, job.datasets[0]), 0.95) << seed;
    lifter->Mirror();
    EXPECT_LT(DepthCorrelation(*lifter, job.datasets[0]), -0.95) << seed;
    const TrainingSplit split = MakeTrainingSplit(job.datasets, 0.0);
    const PerspectiveSlope slope = MeasurePerspectiveSlope(*lifter, split.training, 0, torch::kCPU);
    EXPECT_TRUE(slope.is_sure() && slope.is_mirrored()) << seed << ": " << slope.Describe();
  }
  // Which mirror training finds is chance; these seeds have both, so that both decisions are tried.
  EXPECT_GT(flipped, 0);
  EXPECT_LT(flipped, 3);
}

TEST(Train, WithACalibrationDepthsAreLearnedFromTriangulatedPoses) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run", "epipolar");
  job.datasets = {CalibratedRing(120, 3)};
  for (CameraView& view : job.datasets[0].sequences[0].cameras) view.truth = {};
  job.options.width = 32;
  job.options.epochs = 150;
  job.options.learning_rate = 2e-3;
  const TrainReport report = Train(job);
  EXPECT_EQ(report.model.info.mirror.decision, "known from the calibration");
  const auto lifter = MakeLifter(ReadModelFile(job.run_folder), "model.cpm", torch::kCPU);
  EXPECT_GT(DepthCorrelation(*lifter, CalibratedRing(60, 3)), 0.9);

  job = Job(folder, "bare", "epipolar");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("`calibration`"));
}

TEST(Train, WithTruthDepthsAreLearnedTheRightWayRound) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run", "supervised");
  job.datasets = {PuppetShow(120, 2)};
  // The truth of some frames is unknown in one camera.
  std::vector<float>& truth = job.datasets[0].sequences[0].cameras[0].truth.positions();
  std::fill(truth.begin(), truth.begin() + 20 * kJoints * 3, std::numeric_limits<float>::quiet_NaN());
  job.options.width = 32;
  job.options.epochs = 150;
  job.options.learning_rate = 2e-3;
  const TrainReport report = Train(job);
  EXPECT_EQ(report.model.info.mirror.decision, "known from the truth");
  EXPECT_EQ(report.model.info.trap.verdict, "");
  const auto lifter = MakeLifter(ReadModelFile(job.run_folder), "model.cpm", torch::kCPU);
  EXPECT_GT(DepthCorrelation(*lifter, PuppetShow(120, 2, /*seed=*/2)), 0.9);

  // One camera is enough where the truth is known.
  job.datasets = {PuppetShow(40, 1)};
  job.run_folder = folder / "one";
  job.options.epochs = 1;
  EXPECT_EQ(Train(job).model.info.steps, 5);
}

TEST(Train, SupervisionWithoutTruthIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run", "supervised");
  for (CameraView& view : job.datasets[0].sequences[0].cameras) view.truth = {};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("show.h5: expected truth"));
  job.options.supervision = Supervision::kSolved;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("run `canonpose solve` first"));
  job.options.perspective = PerspectiveForm::kLearned;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Train(job); }), HasSubstr("supervision"));
}

TEST(Train, RotationsStartSpreadOutExactly) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "plain", "paper");
  job.options.epochs = 1;
  job.options.learning_rate = 1e-30;  // training leaves all weights as they are
  job.options.mirror = MirrorHandling::kKeep;
  Train(job);
  job.run_folder = folder / "spread";
  job.options.rotation_spread = 10.0;
  Train(job);
  const ModelFile plain = ReadModelFile(folder / "plain");
  const ModelFile spread = ReadModelFile(folder / "spread");
  for (const auto& [name, array] : plain.parameters) {
    const float factor = name.starts_with("enc_rot.") ? 10.0F : 1.0F;
    for (std::size_t i = 0; i < array.values.size(); ++i) {
      ASSERT_EQ(spread.parameters.at(name).values[i], factor * array.values[i]) << name << "[" << i << "]";
    }
  }
}

TEST(Train, CameraConsistencyWithinWindowsServesMovingCamerasAndIsResumable) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "window", "paper");
  job.datasets[0].sequences[0].static_cameras = false;
  job.options.camera_consistency = CameraConsistency::kWindow;
  job.options.camera_window_seconds = 0.5;
  Train(job);
  std::istringstream metrics(ReadFile(job.run_folder / "metrics.jsonl"));
  std::vector<double> camera;
  for (std::string line; std::getline(metrics, line);) {
    const std::size_t at = line.find("\"camera\":") + 9;
    camera.push_back(std::stod(line.substr(at)));
  }
  ASSERT_EQ(camera.size(), 20U);
  EXPECT_GT(camera.front(), 0.0);
  EXPECT_EQ(camera.back(), 0.0);  // the window has closed

  TrainJob pieces = job;
  pieces.run_folder = folder / "pieces";
  pieces.options.checkpoint_seconds = 0.0;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const bool stopped = StoppedAfter(5 + 7 * attempt, [&] { return Train(pieces).stopped; });
    pieces.resume = true;
    if (!stopped) break;
  }
  EXPECT_EQ(ReadModelFile(folder / "window").parameters.at("upscale.weight").values,
            ReadModelFile(folder / "pieces").parameters.at("upscale.weight").values);
}

TEST(Train, MirrorByRequestIsTheExactMirror) {
  const TemporaryFolder folder;
  TrainJob keep = Job(folder, "keep", "paper");
  keep.options.mirror = MirrorHandling::kKeep;
  TrainJob flip = Job(folder, "flip", "paper");
  flip.options.mirror = MirrorHandling::kFlip;
  EXPECT_EQ(Train(keep).model.info.mirror.decision, "kept by request");
  EXPECT_EQ(Train(flip).model.info.mirror.decision, "flipped by request");
  const auto kept = MakeLifter(ReadModelFile(folder / "keep"), "", torch::kCPU);
  const auto flipped = MakeLifter(ReadModelFile(folder / "flip"), "", torch::kCPU);
  kept->Mirror();
  for (const auto& item : kept->named_parameters()) {
    EXPECT_TRUE(torch::equal(item.value(), flipped->named_parameters()[item.key()])) << item.key();
  }
}

TEST(Train, ALossThatIsNotFiniteStopsTrainingAndKeepsTheLastGoodModel) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.learning_rate = 1e30;
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { Train(job); }), HasSubstr("learning_rate"));
  for (const auto& [name, array] : ReadModelFile(job.run_folder).parameters) {
    for (const float value : array.values) ASSERT_TRUE(std::isfinite(value)) << name;
  }
}

TEST(Train, WeightsSpoiledByTheLastStepAreNotKept) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  job.options.batch_frames = 1000;  // one step
  job.options.learning_rate = 1e38;
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { Train(job); }), HasSubstr("learning_rate"));
  for (const auto& [name, array] : ReadModelFile(job.run_folder).parameters) {
    for (const float value : array.values) ASSERT_LT(std::abs(value), 1e3) << name;
  }
}

TEST(Train, FrequentCheckpointsKeepTheLastGoodModelToo) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.checkpoint_seconds = 0.0;
  job.options.learning_rate = 1e38;
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { Train(job); }), HasSubstr("step 0"));
  for (const auto& [name, array] : ReadModelFile(job.run_folder).parameters) {
    for (const float value : array.values) ASSERT_LT(std::abs(value), 1e3) << name;
  }
}

TEST(Train, AFailedRunDoesNotTakeAnEarlierModelWithIt) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 2;
  Train(job);
  const std::string model = ReadFile(job.run_folder / "model.cpm");
  job.overwrite = true;
  job.options.learning_rate = 1e38;
  ErrorOf(ErrorKind::kComputation, [&] { Train(job); });
  EXPECT_EQ(ReadFile(job.run_folder / "model.cpm"), model);
}

TEST(Train, ResumingWhereOnlyAModelIsLeftIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  std::filesystem::remove(job.run_folder / "checkpoint.h5");
  job.resume = true;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Train(job); }), HasSubstr("`overwrite`"));
}

TEST(Train, RefusesToReplaceARunUnlessAsked) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Train(job); }), HasSubstr("`resume`"));
  job.overwrite = true;
  Train(job);
}

TEST(Train, ResumingWithOtherDataIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  job.resume = true;
  job.datasets = {PuppetShow(40, 3, /*seed=*/9)};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("fingerprint"));
}

TEST(Train, ResumingWithOtherTruthIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run", "supervised");
  job.options.epochs = 1;
  Train(job);
  job.resume = true;
  Train(job);
  job.datasets[0].sequences[0].cameras[0].truth.positions()[4] += 100.0F;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("fingerprint"));
}

TEST(Train, DamagedCheckpointIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.options.epochs = 1;
  Train(job);
  const std::string whole = ReadFile(job.run_folder / "checkpoint.h5");
  WriteFileAtomically(job.run_folder / "checkpoint.h5", whole.substr(0, whole.size() / 2));
  job.resume = true;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("checkpoint.h5"));
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
  const std::string message = ErrorOf(ErrorKind::kBadInput, [&] { Train(job); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  EXPECT_THAT(message, HasSubstr("free some space"));
  EXPECT_EQ(ReadFile(job.run_folder / "checkpoint.h5"), checkpoint);
}

TEST(Train, OneCameraIsNotEnough) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.datasets = {PuppetShow(40, 1)};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("at least two cameras"));
}

TEST(Train, AFewFramesAreNotEnough) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.datasets = {PuppetShow(4, 3)};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("at least 5 frames to train on"));
  EXPECT_FALSE(std::filesystem::exists(job.run_folder / "model.cpm"));
}

TEST(Train, ARecordingGivenTwiceIsRefused) {
  const TemporaryFolder folder;
  TrainJob job = Job(folder, "run");
  job.datasets.push_back(job.datasets.front());
  job.datasets.back().sequences.front().capture = "another name";
  job.data_files = {"a.h5", "b.h5"};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(job); }), HasSubstr("given once"));
}

}  // namespace
}  // namespace canonpose
