#include "canonpose/pipeline/solve_then_train.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose {
namespace {

using testing::CollectedMessages;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

TrainJob SmallJob(const std::filesystem::path& run_folder) {
  SimulationOptions simulation = testing::SmallSimulation();
  simulation.clips = 1;
  simulation.seconds = 3.0;
  TrainJob job;
  job.datasets = {testing::Simulate(simulation).dataset};
  job.data_files = {"data.h5"};
  job.options = PresetOptions("best");
  job.options.width = 16;
  job.options.epochs = 2;
  job.options.min_steps = 0;
  job.run_folder = run_folder;
  return job;
}

TEST(SolveThenTrain, SolvesFirstAndKeepsWhatItFound) {
  const TemporaryFolder folder;
  const TrainReport report = SolveThenTrain(SmallJob(folder / "run"));
  EXPECT_GT(report.model.info.steps, 0);
  EXPECT_FALSE(report.stopped);
  EXPECT_TRUE(ReadDataset(folder / "run/solved-0.h5").HasSolved());
  EXPECT_THAT(ReadFile(folder / "run/solved.json"), HasSubstr("\"captures\""));
  EXPECT_TRUE(std::filesystem::exists(folder / "run/model.cpm"));
}

TEST(SolveThenTrain, AResumedRunDoesNotSolveAgain) {
  const TemporaryFolder folder;
  TrainJob job = SmallJob(folder / "run");
  SolveThenTrain(job);
  const auto solved_at = std::filesystem::last_write_time(folder / "run/solved-0.h5");
  const std::string model = ReadFile(folder / "run/model.cpm");
  job.resume = true;
  SolveThenTrain(job);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "run/solved-0.h5"), solved_at);
  EXPECT_EQ(ReadFile(folder / "run/model.cpm"), model);
}

TEST(SolveThenTrain, TakesSolvedDataAsTheyAre) {
  const TemporaryFolder folder;
  TrainJob job = SmallJob(folder / "first");
  SolveThenTrain(job);
  const std::string model = ReadFile(folder / "first/model.cpm");
  job.datasets = {ReadDataset(folder / "first/solved-0.h5")};
  job.run_folder = folder / "second";
  SolveThenTrain(job);
  EXPECT_FALSE(std::filesystem::exists(folder / "second/solved-0.h5"));
  EXPECT_EQ(ReadFile(folder / "second/model.cpm"), model);
}

TEST(SolveThenTrain, CapturesOfOneNameInSeveralFilesAreSolvedTogether) {
  const TemporaryFolder folder;
  TrainJob job = SmallJob(folder / "run");
  const Dataset whole = job.datasets.front();
  job.datasets = {whole, whole};
  job.data_files = {"first.h5", "second.h5"};
  KeepFrames(job.datasets[0], {0, 36}, "first.h5");
  KeepFrames(job.datasets[1], {37, 74}, "second.h5");
  const auto focals_of = [&](const char* file) {
    const Dataset solved = ReadDataset(folder / file);
    std::vector<double> focals;
    for (const CameraView& view : solved.sequences.front().cameras) {
      focals.push_back(view.solved_calibration.front().K(0, 0));
    }
    return focals;
  };
  const std::string model = SolveThenTrain(job).model.info.data_files[1];
  EXPECT_EQ(model, "second.h5");
  EXPECT_EQ(focals_of("run/solved-0.h5"), focals_of("run/solved-1.h5"));
  EXPECT_EQ(ReadDataset(folder / "run/solved-1.h5").sequences.front().name, whole.sequences.front().name);

  // A run that was killed between the two files solves again, to the same bits.
  const std::string second = ReadFile(folder / "run/solved-1.h5");
  std::filesystem::remove(folder / "run/solved-1.h5");
  job.resume = true;
  SolveThenTrain(job);
  EXPECT_EQ(ReadFile(folder / "run/solved-1.h5"), second);
}

TEST(SolveThenTrain, DoesNotLearnFromPosesWhoseDepthIsAGuess) {
  const TemporaryFolder folder;
  TrainJob job = SmallJob(folder / "run");
  SimulationOptions simulation = testing::SmallSimulation();
  simulation.clips = 1;
  simulation.seconds = 3.0;
  simulation.rig.distance_m = 300.0;  // no perspective
  job.datasets = {testing::Simulate(simulation).dataset};
  job.options.bootstrap = BootstrapKind::kFactorisation;
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { SolveThenTrain(job); }),
              HasSubstr("cannot be believed: which way round depth is could not be decided"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/solved-0.h5")) << "resuming would take it";
  EXPECT_TRUE(std::filesystem::exists(folder / "run/solved.json"));
}

TEST(SolveThenTrain, RefusesAFolderInUseBeforeSolving) {
  const TemporaryFolder folder;
  TrainJob job = SmallJob(folder / "run");
  SolveThenTrain(job);
  const CollectedMessages messages;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { SolveThenTrain(job); }), HasSubstr("`resume`"));
  EXPECT_EQ(messages.text(), "");
}

TEST(SolveThenTrain, CanBeStoppedWhileItSolves) {
  const TemporaryFolder folder;
  Callbacks callbacks;
  callbacks.stop = [] { return true; };
  const CallbackScope scope(callbacks);
  ErrorOf(ErrorKind::kStopped, [&] { SolveThenTrain(SmallJob(folder / "run")); });
  EXPECT_FALSE(std::filesystem::exists(folder / "run/solved-0.h5"));
}

}  // namespace
}  // namespace canonpose
