#include "canonpose/train/starter.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/model/model_file.h"
#include "canonpose/model/tensors.h"
#include "canonpose/train/augmentation.h"
#include "canonpose/train/losses.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const Skeleton& Human() { return *FindSkeleton("h36m-17"); }

/// A recipe that takes a moment.
StarterOptions Tiny(const TemporaryFolder& cache) {
  StarterOptions options;
  options.threads = 1;
  options.cache_folder = cache.path() / "cache";
  options.recipe.capture.clips = 6;
  options.recipe.capture.frames = 10;
  options.recipe.training.batch_frames = 32;
  options.recipe.training.width = 16;
  options.recipe.training.epochs = 2;
  return options;
}

TEST(Starter, HasTheSameBitsForTheSameSeed) {
  const TemporaryFolder a;
  const TemporaryFolder b;
  const std::filesystem::path model = StarterModel(Human(), Tiny(a));
  EXPECT_EQ(model.parent_path(), a / "cache");
  EXPECT_EQ(ReadFile(model), ReadFile(StarterModel(Human(), Tiny(b))));
  StarterOptions other = Tiny(a);
  other.seed = 1;
  const std::filesystem::path second = StarterModel(Human(), other);
  EXPECT_NE(model, second);
  EXPECT_NE(ReadModelFile(model).parameters.at("pose3d.bias").values,
            ReadModelFile(second).parameters.at("pose3d.bias").values);
}

TEST(Starter, ItsNameTellsWhatItDependsOn) {
  const TemporaryFolder cache;
  const StarterOptions tiny = Tiny(cache);
  const std::filesystem::path model = StarterModel(Human(), tiny);
  const auto differs = [&](const Skeleton& skeleton, const StarterOptions& options) {
    return StarterModel(skeleton, options) != model;
  };
  StarterOptions layout = tiny;
  layout.layout = "coco-17";
  EXPECT_TRUE(differs(Human(), layout));
  StarterOptions wilder = tiny;
  wilder.recipe.capture.wild.tumbled = 0.9;
  EXPECT_TRUE(differs(Human(), wilder));
  StarterOptions surer = tiny;
  surer.recipe.capture.detector.missed_frames = 0.9;
  EXPECT_TRUE(differs(Human(), surer));
  StarterOptions longer = tiny;
  longer.recipe.training.epochs = 3;
  EXPECT_TRUE(differs(Human(), longer));
  EXPECT_TRUE(differs(*FindSkeleton("canonpose-16"), tiny));
  StarterOptions threads = tiny;
  threads.threads = 2;
  EXPECT_FALSE(differs(Human(), threads));
  StarterOptions unknown_layout = tiny;
  unknown_layout.layout = "somebody's own";
  EXPECT_FALSE(differs(Human(), unknown_layout));
}

TEST(Starter, IsTrainedOnce) {
  const TemporaryFolder cache;
  const std::filesystem::path model = StarterModel(Human(), Tiny(cache));
  // What is found is taken as it is: training again would undo the mark.
  ModelFile marked = ReadModelFile(model);
  marked.info.preset = "marked";
  WriteModelFile(model, marked);
  EXPECT_EQ(StarterModel(Human(), Tiny(cache)), model);
  EXPECT_EQ(ReadModelInfo(model).preset, "marked");
}

TEST(Starter, ReplacesADamagedEntry) {
  const TemporaryFolder cache;
  const std::filesystem::path model = StarterModel(Human(), Tiny(cache));
  const std::string whole = ReadFile(model);
  for (const std::string& damaged : {whole.substr(0, whole.size() / 2), std::string("no model"), std::string()}) {
    WriteFileAtomically(model, damaged);
    EXPECT_EQ(StarterModel(Human(), Tiny(cache)), model);
    EXPECT_EQ(ReadFile(model), whole);
  }
  // A model of another shape is none either.
  ModelFile narrow = ReadModelFile(model);
  narrow.info.width = 8;
  WriteModelFile(model, narrow);
  StarterModel(Human(), Tiny(cache));
  EXPECT_EQ(ReadFile(model), whole);
}

TEST(Starter, NeedsNoCache) {
  const TemporaryFolder cache;
  WriteFileAtomically(cache / "cache", "a file where the folder should be");
  StarterOptions options = Tiny(cache);
  options.seed = 77;
  ::testing::internal::CaptureStderr();
  const std::filesystem::path model = StarterModel(Human(), options);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("cannot be kept"));
  EXPECT_TRUE(ReadModelInfo(model).skeleton.SameJoints(Human()));
  // In the same program it is not trained again.
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(StarterModel(Human(), options), model);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

/// An environment variable set for a while.
class Setting {
 public:
  Setting(const char* name, const std::string& value) : name_(name) {
    const char* before = std::getenv(name);
    if (before != nullptr) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Setting() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

/// Whether a file of this name lies anywhere below a folder.
bool Holds(const std::filesystem::path& folder, const std::string& name) {
  std::error_code gone;
  for (std::filesystem::recursive_directory_iterator entry(folder, gone), end; entry != end; entry.increment(gone)) {
    if (entry->path().filename() == name) return true;
    if (gone) break;
  }
  return false;
}

TEST(Starter, LeavesNothingWhereItIsStopped) {
  const TemporaryFolder cache;
  const TemporaryFolder scratch;
  const Setting setting("TMPDIR", scratch.path().string());
  StarterOptions options = Tiny(cache);
  options.recipe.training.epochs = 1000000;
  const auto before = std::signal(SIGTERM, SIG_IGN);
  std::thread interrupter([&] {
    // Training listens for signals once it takes steps, of which the metrics are the first trace.
    while (!Holds(scratch.path(), "metrics.jsonl")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::raise(SIGTERM);
  });
  EXPECT_THAT(ErrorOf(ExitCode::kComputation, [&] { StarterModel(Human(), options); }), HasSubstr("stopped"));
  interrupter.join();
  std::signal(SIGTERM, before);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  EXPECT_FALSE(std::filesystem::exists(cache / "cache"));
}

TEST(Starter, LivesInTheUsersCache) {
  const TemporaryFolder cache;
  const Setting setting("XDG_CACHE_HOME", cache.path().string());
  StarterOptions options = Tiny(cache);
  options.cache_folder.clear();
  EXPECT_EQ(StarterModel(Human(), options).parent_path(), cache / "canonpose");
}

TEST(Starter, KnowsPeopleOnly) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) EXPECT_TRUE(StarterKnows(skeleton)) << skeleton.name;
  const Skeleton bird{"", {"crop", "beak", "left wing", "right wing"}, {-1, 0, 0, 0}, 0, {0, 1, 3, 2}};
  EXPECT_FALSE(StarterKnows(bird));
  const TemporaryFolder cache;
  EXPECT_THAT(ErrorOf(ExitCode::kBadInput, [&] { StarterModel(bird, Tiny(cache)); }), HasSubstr("beak"));
  EXPECT_FALSE(std::filesystem::exists(cache / "cache"));
}

TEST(Starter, LiftsUnknownJointsToNaNAndDoesNotLookAtThem) {
  Skeleton skeleton = Human();
  skeleton.name = "";
  skeleton.joints.emplace_back("tail");
  skeleton.parents.push_back(0);
  skeleton.mirror.push_back(17);
  ASSERT_TRUE(StarterKnows(skeleton));
  const TemporaryFolder cache;
  const ModelFile model = ReadModelFile(StarterModel(skeleton, Tiny(cache)));
  const auto lifter = MakeLifter(model, "starter", torch::kCPU);
  const torch::NoGradGuard no_grad;
  torch::Tensor input = torch::full({1, 54}, 0.1F);
  const torch::Tensor pose = lifter->forward(input).pose;  // (1, 3, 18)
  EXPECT_TRUE(torch::isnan(pose.select(2, 17)).all().item<bool>());
  EXPECT_TRUE(torch::isfinite(pose.narrow(2, 0, 17)).all().item<bool>());
  for (const std::int64_t column : {17, 35, 53}) input.select(1, column).fill_(5.0F);
  EXPECT_TRUE(torch::equal(lifter->forward(input).pose.narrow(2, 0, 17), pose.narrow(2, 0, 17)));
}

/// Mean distance to the truth, in the unit of poses of norm 1, of a lifter's poses; of the mean pose without one.
double ErrorOn(const Dataset& dataset, const ModelFile* model) {
  const torch::NoGradGuard no_grad;
  // The starter's viewing ray is on the optical axis, in and out; the mean pose is that of the same rows.
  const TrainingSplit split = MakeTrainingSplit({dataset}, 0.0, RowFormOf(StarterRecipe::Default().training));
  std::vector<const TrainingFrame*> frames;
  for (const TrainingFrame& frame : split.training.frames) frames.push_back(&frame);
  const BatchTensors batch = GatherBatch(split.training, frames, torch::kCPU);
  const int root = dataset.skeleton.root;
  if (model != nullptr) {
    return ComputeSupervisedLoss(MakeLifter(*model, "", torch::kCPU)->forward(LifterInput(batch)), batch, root)
        .total.item<double>();
  }
  LifterOutput mean;
  mean.pose = batch.target.mean(0, true).expand_as(batch.target);
  mean.rotation = torch::eye(3).expand({batch.target.size(0), 3, 3});
  return ComputeSupervisedLoss(mean, batch, root).total.item<double>();
}

TEST(Starter, KnowsMoreOfUnseenPeopleThanTheMeanPose) {
  const TemporaryFolder cache;
  StarterOptions options = Tiny(cache);
  options.recipe.capture.clips = 150;
  options.recipe.capture.frames = 20;
  options.recipe.training.width = 64;
  options.recipe.training.epochs = 20;
  options.recipe.training.learning_rate = 3e-3;
  const auto start = std::chrono::steady_clock::now();
  const ModelFile model = ReadModelFile(StarterModel(Human(), options));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  WildCaptureOptions unseen = options.recipe.capture;
  unseen.seed = 1000;
  unseen.clips = 40;
  const Dataset people = MakeWildCapture(Human(), unseen);
  const double error = ErrorOn(people, &model);
  const double of_mean = ErrorOn(people, nullptr);
  RecordProperty("error", std::to_string(error));
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_LT(error, 0.65 * of_mean) << "the mean pose: " << of_mean;
}

}  // namespace
}  // namespace canonpose
