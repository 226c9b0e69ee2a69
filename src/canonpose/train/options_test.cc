#include "canonpose/train/options.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/train/morph_options.h"
#include "canonpose/train/options_document.h"
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

// Model files and checkpoints hold this text: what was written before must be read, and written again the same.
TEST(TrainOptions, JsonOfEarlierFilesIsReadAndWrittenAsItWas) {
  const std::string earlier =
      R"({"preset":"best","epochs":0,"default_epochs":100,"min_steps":3000,"network":"canonical","width":256,)"
      R"("batch_frames":32,"learning_rate":0.001,"weight_decay":1e-05,"schedule":"cosine","supervision":"solved",)"
      R"("bootstrap":"auto","input_confidences":"missing","loss_confidences":"on","consistency":"mixing","ray":"root",)"
      R"("focal":"guess","rotation":"axis_angle","new_views":0.8,"flips":0.5,"joint_dropout":0.15,)"
      R"("uncertainty_weights":"off","view_weight":1.0,"camera_weight":0.1,"camera_consistency":"off",)"
      R"("camera_window_seconds":3.0,"camera_window_end":0.5,"rotation_spread":1.0,"restarts":1,"restart_steps":1000,)"
      R"("perspective":"off","perspective_warmup":0.3,"perspective_learning_rate":0.01,"mirror":"auto",)"
      R"("validation":0.1,"seed":0,"threads":0,"device":"cpu","checkpoint_seconds":30.0})";
  EXPECT_EQ(TrainOptions::FromJson(earlier, "file").ToJson(), earlier);
  EXPECT_EQ(PresetOptions("best").ToJson(), earlier);
  // Fields that did not exist yet have their defaults, unknown ones are ignored.
  EXPECT_EQ(TrainOptions::FromJson(R"({"width": 7, "gone": 1})", "file").restarts, 1);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { TrainOptions::FromJson(R"({"ray": "sideways"})", "run"); }),
              AllOf(HasSubstr("run"), HasSubstr("`ray`"), HasSubstr("off, root"), HasSubstr("sideways")));
}

TEST(TrainOptions, DescriptionsStateTheDefaultsOfThePresets) {
  const auto described = [](const std::string& name) {
    const auto found = std::ranges::find(DescribeTrainOptions(), name, &OptionDescription::name);
    return found->ToText();
  };
  EXPECT_EQ(described("width"), "Width of the network's layers (1 to 65536; default 1024; 256 for plus and best)");
  EXPECT_THAT(described("learning_rate"), HasSubstr("default 0.0001; 0.001 for plus, martinez and best"));
  EXPECT_THAT(described("mirror"), AllOf(HasSubstr("keep: "), HasSubstr("(default auto)")));
  for (const Preset& preset : Presets()) {
    const TrainOptions options = PresetOptions(preset.name);
    options.Validate();
    for (const auto& [field, value] : preset.differences) {
      EXPECT_EQ(options.Get(field), value) << preset.name;
      EXPECT_NE(TrainOptions().Get(field), value) << preset.name << " names a default: " << field;
    }
  }
}

TEST(MorphOptions, MistakesAreNamed) {
  MorphOptions options;
  options.Set("batch_poses", "64");
  EXPECT_EQ(options.batch_poses, 64);
  EXPECT_EQ(options.ToJson(),
            R"({"epochs":20,"width":256,"batch_poses":64,"learning_rate":0.001,"validation":0.1,"seed":0})");
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("batch", "1"); }), HasSubstr("batch_poses"));
  options.epochs = 0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }),
              AllOf(HasSubstr("`epochs`"), HasSubstr("1 or more")));
}

TEST(OptionsDocument, IsWhatTheTablesSay) {
  const std::filesystem::path file = testing::TestData("../docs/training-options.md");
  if (std::getenv("CANONPOSE_WRITE_DOCS") != nullptr) WriteFileAtomically(file, TrainingOptionsDocument());
  EXPECT_EQ(ReadFile(file), TrainingOptionsDocument()) << "write it again as it says at its beginning";
}

TEST(TrainOptions, PublishedValues) {
  const TrainOptions paper = PresetOptions("paper");
  EXPECT_EQ(paper.width, 1024);
  EXPECT_EQ(paper.batch_frames, 32);
  EXPECT_EQ(paper.learning_rate, 1e-4);
  EXPECT_EQ(paper.weight_decay, 1e-5);
  EXPECT_EQ(paper.camera_consistency, CameraConsistency::kOff);
  EXPECT_EQ(paper.perspective, PerspectiveForm::kOff);
  EXPECT_EQ(PresetOptions("paper+c").camera_consistency, CameraConsistency::kStatic);
  EXPECT_EQ(PresetOptions("paper+c").camera_weight, 0.1);
  EXPECT_EQ(PresetOptions("plus").perspective, PerspectiveForm::kLearned);
  EXPECT_EQ(PresetOptions("plus").camera_consistency, CameraConsistency::kStatic);
  EXPECT_EQ(PresetOptions("supervised").new_views, 0.0);
  EXPECT_EQ(PresetOptions("supervised").ray, RayForm::kOff);
  EXPECT_EQ(MakeSchedule(paper, 3200000).epochs, 100);
}

TEST(TrainOptions, SmallRecordingsArePassedThroughMoreOften) {
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
              HasSubstr("`preset=paper`"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("camera_consistency", "windows"); }),
              AllOf(HasSubstr("off, static, window"), HasSubstr("\"windows\"")));
  options.camera_consistency = CameraConsistency::kWindow;
  options.camera_window_seconds = 0.0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("camera_window_seconds"));
  options.camera_window_seconds = 1.0;
  options.restarts = 0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("restarts"));
  options.restarts = 1;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Set("perspective", "yes"); }),
              HasSubstr("off, learned"));
  options.learning_rate = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }),
              AllOf(HasSubstr("`learning_rate`"), HasSubstr("more than 0"), HasSubstr("inf")));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { PresetOptions("papper"); }),
              AllOf(HasSubstr("papper"), HasSubstr("paper+c")));
}

TEST(TrainOptions, AblationsAndBaselinesGoWithWhatTheyChange) {
  const auto complaint = [](const std::string& preset, const std::string& name, const std::string& value) {
    TrainOptions options = PresetOptions(preset);
    options.Set(name, value);
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); });
  };
  EXPECT_THAT(complaint("paper", "network", "martinez"), HasSubstr("needs `supervision`"));
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
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { unsupervised.Validate(); }),
                HasSubstr("need `supervision`"));
    options.Set(name, "1.5");
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr(name));
    options.Set(name, "0");
  }
  TrainOptions turned = PresetOptions("paper");
  turned.ray = RayForm::kRoot;
  turned.Validate();
  turned.camera_consistency = CameraConsistency::kStatic;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { turned.Validate(); }), HasSubstr("camera_consistency"));
}

TEST(LearningRateFactor, CosineFallsFromOneToZeroStepByStep) {
  TrainOptions options;
  options.schedule = RateSchedule::kCosine;
  const Schedule schedule{10, 20};
  EXPECT_EQ(LearningRateFactor(options, schedule, 0), 1.0);
  EXPECT_NEAR(LearningRateFactor(options, schedule, 100), 0.5, 1e-12);
  EXPECT_LT(LearningRateFactor(options, schedule, 199), 1e-3);
  options.schedule = RateSchedule::kSteps;
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
