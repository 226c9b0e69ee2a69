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
  EXPECT_GT(report.model.steps, 0);
  EXPECT_FALSE(report.stopped);
  EXPECT_TRUE(ReadDataset(folder / "run/solved-0.h5").HasSolved());
  EXPECT_THAT(ReadFile(folder / "run/solved-0.json"), HasSubstr("\"captures\""));
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
