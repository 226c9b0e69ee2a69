#include "canonpose/train/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/train/schedule.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;

TEST(TrainOptions, JsonRoundTripKeepsEveryField) {
  TrainOptions options = PresetOptions("plus");
  options.Set("learning_rate", "0.00123");
  options.Set("seed", "18446744073709551615");
  options.Set("camera_consistency", "off");
  const TrainOptions read = TrainOptions::FromJson(options.ToJson(), "file");
  EXPECT_EQ(read.ToJson(), options.ToJson());
  EXPECT_EQ(read.seed, UINT64_MAX);
  EXPECT_TRUE(read.Differences(options).empty());
  EXPECT_THAT(options.ToJson(true), ::testing::Not(HasSubstr("checkpoint_seconds")));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { TrainOptions::FromJson("{\"width\": ", "run"); }), HasSubstr("run"));
}

TEST(TrainOptions, PublishedValues) {
  const TrainOptions paper = PresetOptions("paper");
  EXPECT_EQ(paper.width, 1024);
  EXPECT_EQ(paper.batch_frames, 32);
  EXPECT_EQ(paper.learning_rate, 1e-4);
  EXPECT_EQ(paper.weight_decay, 1e-5);
  EXPECT_EQ(paper.camera_consistency, "off");
  EXPECT_EQ(paper.perspective, "off");
  EXPECT_EQ(PresetOptions("paper+c").camera_consistency, "static");
  EXPECT_EQ(PresetOptions("paper+c").camera_weight, 0.1);
  EXPECT_EQ(PresetOptions("plus").perspective, "learned");
  EXPECT_EQ(PresetOptions("plus").camera_consistency, "static");
  EXPECT_EQ(PresetOptions("supervised").new_views, 0.0);
  EXPECT_EQ(PresetOptions("supervised").ray, "off");
  EXPECT_EQ(MakeSchedule(paper, 3200000).epochs, 100);
}

TEST(TrainOptions, SmallRecordingsAreGoneThroughMoreOften) {
  TrainOptions options;
  options.min_steps = 1500;
  const Schedule schedule = MakeSchedule(options, 90);
  EXPECT_EQ(schedule.steps_per_epoch, 3);
  EXPECT_EQ(schedule.epochs, 500);
  options.epochs = 7;
  EXPECT_EQ(MakeSchedule(options, 90).epochs, 7);
}

TEST(LearningRateFactor, FallsAtThePublishedEpochs) {
  EXPECT_EQ(LearningRateFactor(29, 100), 1.0);
  EXPECT_NEAR(LearningRateFactor(30, 100), 0.1, 1e-12);
  EXPECT_NEAR(LearningRateFactor(60, 100), 0.01, 1e-12);
  EXPECT_NEAR(LearningRateFactor(90, 100), 0.001, 1e-12);
}

TEST(TrainOptions, MistakesAreNamed) {
  TrainOptions options;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("learning_rat", "1"); }),
              AllOf(HasSubstr("learning_rat"), HasSubstr("learning_rate")));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("width", "12.5"); }), HasSubstr("12.5"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("width", ""); }), HasSubstr("whole number"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("preset", "paper"); }),
              HasSubstr("`preset` paper"));
  options.camera_consistency = "windows";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("off, static, window"));
  options.camera_consistency = "window";
  options.camera_window_seconds = 0.0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("camera_window_seconds"));
  options.camera_window_seconds = 1.0;
  options.restarts = 0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("restarts"));
  options.restarts = 1;
  options.perspective = "yes";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("off, learned"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { PresetOptions("papper"); }),
              AllOf(HasSubstr("papper"), HasSubstr("paper+c")));
}

TEST(TrainOptions, AblationsAndBaselinesGoWithWhatTheyChange) {
  const auto complaint = [](const std::string& preset, const std::string& name, const std::string& value) {
    TrainOptions options = PresetOptions(preset);
    options.Set(name, value);
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); });
  };
  EXPECT_THAT(complaint("paper", "network", "martinez"), HasSubstr("needs supervision"));
  EXPECT_THAT(complaint("paper", "consistency", "equal_cameras"), HasSubstr("camera_consistency"));
  EXPECT_THAT(complaint("supervised", "consistency", "equal_poses"), HasSubstr("supervision=truth"));
  EXPECT_THAT(complaint("supervised", "loss_confidences", "off"), HasSubstr("supervision=truth"));
  EXPECT_THAT(complaint("martinez", "rotation", "6d"), HasSubstr("no rotation"));
  for (const char* preset : {"martinez", "epipolar"}) PresetOptions(preset).Validate();
}

TEST(TrainOptions, WhatChangesA3dPoseNeedsOne) {
  TrainOptions options = PresetOptions("best");
  options.Validate();
  for (const char* name : {"new_views", "flips", "joint_dropout"}) {
    TrainOptions unsupervised = PresetOptions("paper");
    unsupervised.Set(name, "0.5");
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { unsupervised.Validate(); }), HasSubstr("need supervision"));
    options.Set(name, "1.5");
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr(name));
    options.Set(name, "0");
  }
  TrainOptions turned = PresetOptions("paper");
  turned.ray = "root";
  turned.Validate();
  turned.camera_consistency = "static";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { turned.Validate(); }), HasSubstr("camera_consistency"));
}

TEST(LearningRateFactor, CosineFallsFromOneToNothingStepByStep) {
  TrainOptions options;
  options.schedule = "cosine";
  const Schedule schedule{10, 20};
  EXPECT_EQ(LearningRateFactor(options, schedule, 0), 1.0);
  EXPECT_NEAR(LearningRateFactor(options, schedule, 100), 0.5, 1e-12);
  EXPECT_LT(LearningRateFactor(options, schedule, 199), 1e-3);
  options.schedule = "steps";
  EXPECT_EQ(LearningRateFactor(options, schedule, 59), 1.0);
  EXPECT_NEAR(LearningRateFactor(options, schedule, 60), 0.1, 1e-12);
}

TEST(TrainOptions, DifferencesIgnoreWhatDoesNotChangeTheResult) {
  const TrainOptions a;
  TrainOptions b;
  b.checkpoint_seconds = 1;
  b.device = "cuda";
  EXPECT_TRUE(a.Differences(b).empty());
  b.width = 7;
  EXPECT_THAT(a.Differences(b), ElementsAre("width"));
}

}  // namespace
}  // namespace canonpose
