// The program from the user's side: commands, files, exit codes, and training that is killed.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/cli/terminal_testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/dataset.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Become;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::HasTrained;
using testing::Lasting;
using ::testing::Not;
using testing::Outcome;
using testing::Output;
using testing::SaidTo;
using testing::Shared;
using testing::Start;
using testing::TemporaryFolder;
using testing::TestData;
using testing::Wait;

/// A dataset of a random body that rotates, with truth.
void WriteData(const fs::path& path, int frames = 40, int joints = 5, std::int64_t version = 1) {
  Rng rng(1);
  h5::File file = h5::File::CreateAt(path);
  file.root().SetString("format", "canonpose-dataset");
  file.root().SetInt("version", version);
  {
    h5::Group skeleton = file.root().Create("skeleton");
    std::vector<std::string> names;
    std::vector<std::int64_t> parents;
    std::vector<std::int64_t> mirror;
    for (int j = 0; j < joints; ++j) {
      names.push_back("joint" + std::to_string(j));
      parents.push_back(j - 1);
      mirror.push_back(j);
    }
    skeleton.SetStrings("joints", names);
    skeleton.SetInts("parents", parents);
    skeleton.SetInt("root", 0);
    skeleton.SetInts("mirror", mirror);
    h5::Group sequence = file.root().Create("sequences").Create("clip");
    sequence.SetString("subject", "s");
    sequence.SetDouble("fps", 30.0);
    sequence.SetInt("static_cameras", 1);
    h5::Group cameras = sequence.Create("cameras");
    for (const char* name : {"a", "b", "c"}) {
      h5::Group camera = cameras.Create(name);
      camera.SetInts("image_size", {1000, 1000});
      std::vector<float> keypoints;
      std::vector<float> truth;
      const auto count = static_cast<std::size_t>(frames * joints);
      for (std::size_t i = 0; i < count; ++i) {
        const double x = rng.Normal();
        const double y = rng.Normal();
        const double z = rng.Normal();
        keypoints.insert(keypoints.end(), {static_cast<float>(500 + 100 * x), static_cast<float>(500 + 100 * y)});
        truth.insert(truth.end(),
                     {static_cast<float>(300 * x), static_cast<float>(300 * y), static_cast<float>(3000 + 300 * z)});
      }
      const auto t = static_cast<std::size_t>(frames);
      const auto j = static_cast<std::size_t>(joints);
      camera.Write<float>("keypoints", keypoints, {t, j, 2});
      camera.Write<float>("confidence", std::vector<float>(count, 0.9F), {t, j});
      camera.Write<float>("truth", truth, {t, j, 3});
    }
  }
  file.Commit();
}

std::vector<std::string> TrainArguments(const fs::path& data, const fs::path& run) {
  return {"train", data, "-o", run, "--preset", "plus", "--width", "24", "--epochs", "3", "--threads", "1"};
}

TEST(Program, ImportsBenchmarks) {
  const TemporaryFolder folder;
  const fs::path files = TestData("benchmarks");
  const std::vector<std::vector<std::string>> commands = {
      {"h36m", files / "h36m/data_2d_h36m_gt.npz", files / "h36m/data_3d_h36m.npz", "--calibration",
       files / "h36m/cameras.json"},
      {"canonpose-detections", files / "canonpose/detections_p2.pickle", "--image-size", "1000x1000"},
      {"3dhp-train", files / "3dhp_train/S1/Seq1/annot.mat", files / "3dhp_train/S2/Seq2/annot.mat", "--cameras",
       "0,2,4,7,8", "--truth", "annot3"},
      {"3dhp-test", files / "3dhp_test/TS1/annot_data.mat", files / "3dhp_test/TS5/annot_data.mat"},
      {"skipose", files / "skipose/train"}};
  for (const std::vector<std::string>& command : commands) {
    const fs::path out = folder / (command.front() + ".h5");
    std::vector<std::string> arguments = {"import"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    arguments.insert(arguments.end(), {"-o", out});
    const Outcome outcome = Execute(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr("per sequence"));
  }
  EXPECT_THAT(Execute({"info", folder / "3dhp-test.h5"}).output,
              AllOf(HasSubstr("made from    3dhp-test"), HasSubstr("univ_annot3"), HasSubstr("On The Floor")));
  // A sequence of one camera is for evaluation.
  const fs::path run = folder / "run";
  ASSERT_TRUE(HasTrained(Execute({"train", folder / "skipose.h5", "-o", run, "--preset", "plus", "--width", "24",
                                  "--epochs", "1", "--threads", "1"})));
  const Outcome measured = Execute({"evaluate", run, folder / "3dhp-test.h5"});
  EXPECT_EQ(measured.exit_code, 0) << measured.errors;

  const std::string out = folder / "x.h5";
  EXPECT_EQ(Execute({"import", "skipose", files / "skipose/train", "-o", out, "--person", "2"}).exit_code, 2);
  EXPECT_EQ(Execute({"import", "openpose", files, "-o", out, "--truth", "annot3"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(out));
}

TEST(Program, UsageMistakesExitWithTwo) {
  EXPECT_EQ(Execute({}).exit_code, 2);
  EXPECT_EQ(Execute({"fly"}).exit_code, 2);
  EXPECT_EQ(Execute({"train"}).exit_code, 2);
  EXPECT_EQ(Execute({"evaluate", "--protocol", "nonsense", "--predictions", "a", "--truth", "b"}).exit_code, 2);
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  EXPECT_EQ(Execute({"train", folder / "data.h5", "-o", folder / "run", "--set", "nonsense=1"}).exit_code, 2);
  EXPECT_EQ(Execute({"train", folder / "data.h5", "-o", folder / "run", "--preset", "nonsense"}).exit_code, 2);
  EXPECT_EQ(Execute({"train", folder / "data.h5", "-o", folder / "run", "--frames", "9-3"}).exit_code, 2);
  EXPECT_EQ(Execute({"train", folder / "data.h5", folder / "data.h5", "-o", folder / "run"}).exit_code, 2);
  EXPECT_EQ(Execute({"lift", "model", "data", "-o", folder / "poses.xyz"}).exit_code, 2);
}

TEST(Program, EveryCommandHasHelp) {
  EXPECT_EQ(Execute({"--help"}).exit_code, 0);
  EXPECT_EQ(Execute({"--version"}).exit_code, 0);
  for (const char* command : {"import", "simulate", "train", "evaluate", "solve", "lift", "info"}) {
    const Outcome outcome = Execute({command, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_THAT(outcome.output, HasSubstr("--")) << command;
  }
}

TEST(Program, TrainEvaluateLiftInfo) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  const Outcome trained = Execute(TrainArguments(folder / "data.h5", folder / "run"));
  ASSERT_TRUE(HasTrained(trained)) << trained.errors;
  const Outcome evaluated = Execute({"evaluate", folder / "run", folder / "data.h5", "--json", folder / "report.json"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.errors;
  const nlohmann::json report = nlohmann::json::parse(ReadFile(folder / "report.json"));
  for (const char* key : {"protocol", "frames", "joints", "n_mpjpe_mm", "p_mpjpe_mm", "pck150_percent", "auc_percent",
                          "cps", "per_sequence", "per_joint"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["frames"], 120);
  for (const char* extension : {"npz", "csv", "json"}) {
    const fs::path poses = folder / (std::string("poses.") + extension);
    const Outcome lifted = Execute({"lift", folder / "run", folder / "data.h5", "--camera", "b", "-o", poses});
    EXPECT_EQ(lifted.exit_code, 0) << lifted.errors;
    EXPECT_TRUE(fs::exists(poses));
  }
  for (const char* file : {"data.h5", "run", "run/model.cpm", "run/checkpoint.h5", "poses.npz", "poses.csv",
                           "poses.json", "report.json"}) {
    const Outcome info = Execute({"info", folder / file});
    EXPECT_EQ(info.exit_code, 0) << file << info.errors;
    EXPECT_THAT(info.output, HasSubstr("kind"));
  }
  // A camera must be chosen if there are several.
  ExpectBadInput({"lift", folder / "run", folder / "data.h5", "-o", folder / "p.npz"}, HasSubstr("--camera"));
}

TEST(Program, LiftLeavesOutWhatTheViewDoesNotShow) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  Dataset dataset = ReadDataset(folder / "data.h5");
  CameraView& view = dataset.sequences.front().cameras[1];
  constexpr std::size_t kHidden = 7 * 5 + 3;
  view.confidence[kHidden] = 0.0F;
  WriteDataset(folder / "data.h5", dataset);
  const Outcome trained = Execute(TrainArguments(folder / "data.h5", folder / "run"));
  ASSERT_EQ(trained.exit_code, 4) << "random points have no solution that could be believed";
  EXPECT_THAT(trained.message(), AllOf(HasSubstr("model.cpm is written, but"), HasSubstr("which way round depth is")));
  const auto lift = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"lift", folder / "run", folder / "data.h5", "--camera",
                                          "b",    "-o",           folder / output};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Execute(arguments);
  };
  const Outcome hidden = lift("hidden.npz", {});
  EXPECT_EQ(hidden.exit_code, 0);
  EXPECT_THAT(hidden.errors, AllOf(HasSubstr("warning: "), HasSubstr("do not rely on these 3D poses"),
                                   HasSubstr("1 joints were not seen and are left empty")));
  EXPECT_EQ(lift("filled.npz", {"--fill"}).exit_code, 0);
  const NpzReader empty(folder / "hidden.npz");
  const NpzReader filled(folder / "filled.npz");
  std::vector<std::size_t> shape;
  EXPECT_TRUE(std::isnan(empty.ReadFloats("pose3d", &shape)[3 * kHidden]));
  EXPECT_FALSE(std::isnan(empty.ReadFloats("pose3d", &shape)[3 * (kHidden + 1)]));
  EXPECT_FALSE(std::isnan(filled.ReadFloats("pose3d", &shape)[3 * kHidden]));
  for (const NpzReader* file : {&empty, &filled}) {
    EXPECT_EQ(file->ReadFloats("confidence", &shape)[kHidden], 0.0F);
    EXPECT_FLOAT_EQ(file->ReadFloats("confidence", &shape)[kHidden + 1], 0.9F);
    EXPECT_EQ(shape, (std::vector<std::size_t>{40, 5}));
    EXPECT_TRUE(std::isnan(file->ReadFloats("standard_deviation", &shape)[0]));
  }
  EXPECT_THAT(lift("x.npz", {"--smooth", "8"}).message(), HasSubstr("--smooth: expected an odd number"));
  EXPECT_THAT(lift("x.npz", {"--smooth", "41"}).message(), HasSubstr("the 40 frames of the clip"));
  EXPECT_THAT(lift("x.npz", {"--height", "175"}).message(),
              HasSubstr("--height: expected the person's height in metres"));
  EXPECT_EQ(lift("x.npz", {"--frames", "0-500"}).exit_code, 3);
  EXPECT_FALSE(fs::exists(folder / "x.npz"));
}

TEST(Program, BadInputsOfTraining) {
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  WriteData(data);
  ExpectBadInput({"train", folder / "none.h5", "-o", folder / "run"}, HasSubstr("none.h5"));
  ExpectBadInput({"train", data, "-o", "/proc/run"}, HasSubstr("/proc/run"));
  WriteData(folder / "version.h5", 40, 5, 3);
  ExpectBadInput({"train", folder / "version.h5", "-o", folder / "run"},
                 AllOf(HasSubstr("version.h5"), HasSubstr("version"), HasSubstr("found 3")));
  WriteFileAtomically(folder / "cut.h5", ReadFile(data).substr(0, 3000));
  ExpectBadInput({"train", folder / "cut.h5", "-o", folder / "run"}, HasSubstr("cut.h5"));

  ASSERT_TRUE(HasTrained(Execute(TrainArguments(data, folder / "run"))));
  EXPECT_EQ(Execute(TrainArguments(data, folder / "run")).exit_code, 2);  // nothing is lost
  WriteData(folder / "six.h5", 40, 6);
  ExpectBadInput({"evaluate", folder / "run", folder / "six.h5"}, AllOf(HasSubstr("six.h5"), HasSubstr("joint5")));
  const std::string model = ReadFile(folder / "run/model.cpm");
  WriteFileAtomically(folder / "run/model.cpm", model.substr(0, model.size() / 2));
  ExpectBadInput({"evaluate", folder / "run", data}, HasSubstr("model.cpm"));
  const std::string checkpoint = ReadFile(folder / "run/checkpoint.h5");
  WriteFileAtomically(folder / "run/checkpoint.h5", checkpoint.substr(0, checkpoint.size() / 2));
  std::vector<std::string> resume = TrainArguments(data, folder / "run");
  resume.emplace_back("--resume");
  ExpectBadInput(resume, HasSubstr("checkpoint.h5"));
}

TEST(Program, WhatCannotBeTrainedOnIsRefusedBefore) {
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  const std::string run = folder / "run";
  WriteData(data);
  std::vector<std::string> arguments = TrainArguments(data, run);
  arguments.insert(arguments.end(), {"--frames", "7"});
  ExpectBadInput(arguments, AllOf(HasSubstr("data.h5: expected at least 5 frames"), HasSubstr("found 1")));
  arguments.back() = "0-500";
  ExpectBadInput(arguments, AllOf(HasSubstr("data.h5"), HasSubstr("40 frames"), HasSubstr("--frames 0-39")));
  fs::copy_file(data, folder / "copy.h5");
  arguments = TrainArguments(data, run);
  arguments.insert(arguments.begin() + 2, folder / "copy.h5");
  ExpectBadInput(arguments, AllOf(HasSubstr("copy.h5: clip"), HasSubstr("of clip in data.h5"), HasSubstr("held out")));
  arguments = TrainArguments(data, run);
  arguments.insert(arguments.end(), {"--cameras", "a"});
  ExpectBadInput(arguments, HasSubstr("at least two cameras"));
  for (const char* preset : {"plus", "best"}) {
    arguments[5] = preset;
    ExpectBadInput(arguments, HasSubstr("at least two cameras"));
  }
  EXPECT_FALSE(fs::exists(run + "/model.cpm"));
  Dataset one = ReadDataset(data);
  one.sequences.front().cameras.resize(1);
  WriteDataset(folder / "one.h5", one);
  ExpectBadInput({"solve", folder / "one.h5", "-o", folder / "s.h5"},
                 AllOf(HasSubstr("one.h5"), HasSubstr("found one, a")));
}

TEST(Program, AnOutputIsNeitherAnInputNorOfAnotherName) {
  const TemporaryFolder folder;
  const std::string data = folder / "data.h5";
  WriteData(data);
  const std::string before = ReadFile(data);
  const auto expect_refusal = [&](const std::vector<std::string>& arguments, const std::string& text) {
    const Outcome outcome = Execute(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.errors;
    EXPECT_THAT(outcome.message(), HasSubstr(text));
  };
  const std::string keypoints = TestData("detections/openpose");
  expect_refusal({"import", "openpose", keypoints, "-o", folder / "x.csv", "--image-size", "640x480"}, "name it x.h5");
  expect_refusal({"solve", data, "-o", folder / "sol.csv"}, "name it sol.h5");
  expect_refusal({"simulate", "-o", folder / "sim.npz", "--seconds", "1"}, "name it sim.h5");
  expect_refusal({"solve", data, "-o", data}, "would be overwritten");
  expect_refusal({"solve", data, "-o", folder / "s.h5", "--json", data}, "would be overwritten");
  expect_refusal({"evaluate", data, "--json", data}, "would be overwritten");
  expect_refusal({"solve", data, "-o", folder / "s.h5", "--json", folder / "./s.h5"}, "give two files");
  expect_refusal({"evaluate", data, "--json", folder / "e.csv", "--frame-errors", folder / "e.csv"}, "give two files");
  expect_refusal({"import", "openpose", keypoints, "-o", data, "--image-size", "640x480", "--calibration", data},
                 "would be overwritten");
  EXPECT_EQ(ReadFile(data), before);
}

TEST(Program, BadInputsOfImport) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.h5";
  fs::create_directories(folder / "empty");
  ExpectBadInput({"import", "openpose", folder / "empty", "-o", out, "--image-size", "100x100"}, HasSubstr("empty"));
  ExpectBadInput({"import", "openpose", folder / "nowhere", "-o", out, "--image-size", "100x100"},
                 HasSubstr("nowhere"));
  const std::string cameras = TestData("detections/openpose");
  ExpectBadInput({"import", "openpose", cameras, "-o", "/proc/out.h5", "--image-size", "1920x1080"},
                 HasSubstr("/proc/out.h5"));
  ExpectBadInput({"import", "openpose", cameras, "-o", out}, HasSubstr("--image-size"));
  ExpectBadInput({"import", "openpose", cameras, "-o", out, "--image-size", "1920x1080", "--layout", "coco-18"},
                 HasSubstr("coco-18"));
  EXPECT_FALSE(fs::exists(out));
}

TEST(Program, SimulatedCaptureGoesThroughTheWholePipeline) {
  const TemporaryFolder folder;
  const std::vector<std::string> people = {"--subjects", "2", "--clips", "2", "--seconds", "2", "--fps", "20"};
  const auto simulate = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "simulate");
    arguments.insert(arguments.end(), people.begin(), people.end());
    return Execute(arguments);
  };
  const Outcome first = simulate({"-o", folder / "a.h5", "--seed", "3", "--describe", "--openpose", folder / "open",
                                  "--alphapose", folder / "alpha", "--bvh", folder / "bvh"});
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output, AllOf(HasSubstr("LWrist"), HasSubstr("confidence AUC")));
  ASSERT_EQ(simulate({"-o", folder / "b.h5", "--seed", "3", "--threads", "1", "--layout", "body_25b"}).exit_code, 0);
  EXPECT_EQ(ReadFile(folder / "a.h5"), ReadFile(folder / "b.h5")) << "the same seed gives the same bits";
  EXPECT_THAT(Execute({"info", folder / "a.h5"}).output, AllOf(HasSubstr("simulated"), HasSubstr("truth")));

  // The files beside it can be imported like any detector's.
  const fs::path clip = folder / "open" / "person3-1-001-gait";
  EXPECT_EQ(Execute({"import", "openpose", clip, "-o", folder / "o.h5", "--image-size", "1000x1000"}).exit_code, 0);
  EXPECT_EQ(Execute({"import", "alphapose", folder / "alpha" / "person3-1-001-gait", "-o", folder / "p.h5", "--layout",
                     "body_25b", "--image-size", "1000x1000"})
                .exit_code,
            0);
  EXPECT_EQ(Execute({"simulate", folder / "bvh", "-o", folder / "c.h5", "--noise", "0"}).exit_code, 0);
  // An earlier simulation's files are not mixed with new ones.
  EXPECT_EQ(simulate({"-o", folder / "d.h5", "--openpose", folder / "open"}).exit_code, 3);
  EXPECT_FALSE(fs::exists(folder / "d.h5"));

  for (const std::string preset : {"plus", "supervised"}) {
    const Outcome trained = Execute({"train", folder / "a.h5", "-o", folder / preset, "--preset", preset, "--epochs",
                                     "2", "--width", "16", "--threads", "1"});
    EXPECT_TRUE(HasTrained(trained)) << trained.errors;
    EXPECT_THAT(Execute({"evaluate", folder / preset, folder / "a.h5"}).output, HasSubstr("Depth of the poses"));
  }
}

TEST(Program, MorphsADetectorsJoints) {
  const TemporaryFolder folder;
  const auto simulate = [&](const std::string& output, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"simulate", "-o", output, "--seconds", "6", "--fps", "20", "--clips", "3"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return Execute(arguments).exit_code;
  };
  ASSERT_EQ(simulate(folder / "a.h5", {"--joint-offset", "2"}), 0);
  const std::vector<std::string> small = {"--width", "64", "--threads", "1"};
  const auto train_morph = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "train-morph");
    arguments.insert(arguments.end(), small.begin(), small.end());
    return Execute(arguments);
  };
  const Outcome good = train_morph({folder / "a.h5", "-o", folder / "morph", "--learning-rate", "0.003"});
  EXPECT_EQ(good.exit_code, 0) << good.errors;
  EXPECT_THAT(good.errors, AllOf(HasSubstr("joints of held-out poses are off by"), Not(HasSubstr("warning"))));
  EXPECT_EQ(train_morph({folder / "a.h5", "-o", folder / "none", "--subjects", "nobody"}).exit_code, 3);
  const Outcome overwriting =
      Execute({"train", folder / "a.h5", "-o", folder / "morph", "--morph", folder / "morph", "--overwrite"});
  EXPECT_EQ(overwriting.exit_code, 2);
  EXPECT_THAT(overwriting.message(), HasSubstr("would be overwritten"));
  const Outcome trained = Execute({"train", folder / "a.h5", "-o", folder / "run", "--morph", folder / "morph",
                                   "--preset", "martinez", "--epochs", "1", "--width", "16", "--threads", "1"});
  EXPECT_EQ(trained.exit_code, 0) << trained.errors;
  EXPECT_THAT(Execute({"info", folder / "run"}).output, HasSubstr("go through a network of width 64 first"));
  ASSERT_EQ(Execute({"import", "openpose", TestData("detections/openpose"), "-o", folder / "moved.h5", "--image-size",
                     "1920x1080", "--morph", folder / "morph"})
                .exit_code,
            0);
  EXPECT_THAT(Execute({"info", folder / "moved.h5"}).output, HasSubstr("morphed by"));
  EXPECT_THAT(
      Execute({"lift", folder / "run", folder / "moved.h5", "--camera", "cam1", "-o", folder / "poses.npz"}).errors,
      HasSubstr("its keypoints were moved by"));

  // There is nothing to learn if the detector is exact: the result can only be worse, which a warning says.
  ASSERT_EQ(simulate(folder / "exact.h5", {"--noise", "0"}), 0);
  const Outcome worse = train_morph({folder / "exact.h5", "-o", folder / "worse", "--epochs", "1"});
  EXPECT_EQ(worse.exit_code, 0) << worse.errors;
  EXPECT_THAT(worse.errors, HasSubstr("the model makes held-out poses worse"));
}

TEST(Program, SolvesAndDistils) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  const TemporaryFolder folder;
  const std::vector<std::string> people = {"--subjects", "1",     "--activities", "gait,dance", "--seconds",
                                           "6",          "--fps", "20",           "--seed",     "4"};
  std::vector<std::string> simulate = {"simulate", "-o", folder / "a.h5"};
  simulate.insert(simulate.end(), people.begin(), people.end());
  ASSERT_EQ(Execute(simulate).exit_code, 0);
  // A crude lifter to start from, which is quicker to train.
  ASSERT_EQ(Execute({"train", folder / "a.h5", "-o", folder / "start", "--preset", "supervised", "--width", "64",
                     "--set", "min_steps=300", "--set", "learning_rate=0.002", "--epochs", "30", "--threads", "1"})
                .exit_code,
            0);
  const auto solve = [&](const std::string& output, const std::string& threads) {
    return Execute({"solve", folder / "a.h5", "-o", folder / output, "--model", folder / "start", "--json",
                    folder / (output + ".json"), "--threads", threads});
  };
  const Outcome solved = solve("solved.h5", "1");
  ASSERT_EQ(solved.exit_code, 0) << solved.errors;
  EXPECT_THAT(solved.output, AllOf(HasSubstr("mirror"), HasSubstr("focal length")));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(folder / "solved.h5.json"))["captures"].size(), 1U);
  ASSERT_EQ(solve("again.h5", "2").exit_code, 0);
  EXPECT_EQ(ReadFile(folder / "solved.h5"), ReadFile(folder / "again.h5")) << "the number of threads changes nothing";

  ASSERT_EQ(Execute({"evaluate", folder / "solved.h5", "--json", folder / "figures.json"}).exit_code, 0);
  const auto figures = nlohmann::json::parse(ReadFile(folder / "figures.json"));
  EXPECT_LT(figures["p_mpjpe_mm"].get<double>(), 30.0);
  EXPECT_LT(figures["mirrored_percent"].get<double>(), 2.0);
  EXPECT_LT(figures["cameras"]["relative_rotation_deg"].get<double>(), 4.0);
  EXPECT_LT(figures["world"]["wa_mpjpe_mm"].get<double>(), 60.0);
  EXPECT_FALSE(figures["world"].contains("w_mpjpe_mm")) << "without a size there is no error without scale";

  const std::vector<std::string> best = {
      "train",         folder / "solved.h5", "-o", folder / "best", "--preset", "best",      "--set",
      "min_steps=200", "--epochs",           "20", "--width",       "64",       "--threads", "1"};
  const Outcome trained = Execute(best);
  EXPECT_EQ(trained.exit_code, 0) << trained.errors;
  EXPECT_EQ(Execute({"evaluate", folder / "best", folder / "a.h5"}).exit_code, 0);
  EXPECT_EQ(Execute({"solve", folder / "a.h5", "-o", folder / "x.h5", "--mirror", "sideways"}).exit_code, 2);
  EXPECT_EQ(Execute({"solve", folder / "none.h5", "-o", folder / "x.h5"}).exit_code, 3);
  const Outcome too_tall = Execute({"solve", folder / "a.h5", "-o", folder / "x.h5", "--height", "175"});
  EXPECT_EQ(too_tall.exit_code, 2);
  EXPECT_THAT(too_tall.errors, AllOf(HasSubstr("--height"), HasSubstr("give 1.75")));
  EXPECT_EQ(Execute({"solve", folder / "a.h5", "-o", folder / "x.h5", "--camera-distance", "cam1,cam9=4"}).exit_code,
            2);
  EXPECT_EQ(Execute({"solve", folder / "a.h5", "-o", folder / "x.h5", "--model", folder / "none"}).exit_code, 3);
}

TEST(Program, SolvesSeveralFilesTogether) {
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"simulate", "-o", folder / "a.h5", "--subjects", "1", "--clips", "1", "--activities", "dance",
                     "--seconds", "8", "--fps", "15", "--seed", "4"})
                .exit_code,
            0);
  const Dataset whole = ReadDataset(folder / "a.h5");
  for (const auto& [name, range] : {std::pair("first.h5", FrameRange{0, 59}), {"second.h5", FrameRange{60, 119}}}) {
    Dataset half = whole;
    KeepFrames(half, range, name);
    WriteDataset(folder / name, half);
  }
  const Outcome solved = Execute({"solve", folder / "first.h5", folder / "second.h5", "-o", folder / "solved.h5",
                                  "--threads", "1", "--camera-distance", "cam1,cam3=10"});
  ASSERT_EQ(solved.exit_code, 0) << solved.errors;
  EXPECT_THAT(solved.output, HasSubstr("120 of 120 solved")) << "one capture";
  const Dataset result = ReadDataset(folder / "solved.h5");
  const std::string name = whole.sequences.front().name;
  ASSERT_EQ(result.sequences.size(), 2U);
  EXPECT_EQ(result.sequences[0].name, name);
  EXPECT_EQ(result.sequences[1].name, "second-" + name);
  for (std::size_t c = 0; c < result.sequences[0].cameras.size(); ++c) {
    EXPECT_EQ(result.sequences[0].cameras[c].solved_calibration[0].K,
              result.sequences[1].cameras[c].solved_calibration[0].K);
  }
  EXPECT_EQ(result.sequences[0].cameras[0].solved.unit, LengthUnit::kMillimetres);
  EXPECT_THAT(result.sequences[1].solved_world.scale.source, HasSubstr("cam1 and cam3, 10 m"));
  const Outcome evaluated =
      Execute({"evaluate", folder / "solved.h5", "--json", folder / "figures.json", "--exclude-joints", "Nose"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.errors;
  EXPECT_THAT(evaluated.output, AllOf(HasSubstr("W-MPJPE"), HasSubstr("TE")));
  const auto figures = nlohmann::json::parse(ReadFile(folder / "figures.json"));
  EXPECT_GT(figures["world"]["w_mpjpe_mm"].get<double>(), figures["world"]["pa_mpjpe_mm"].get<double>());
  EXPECT_GT(figures["cameras"]["te_mm"].get<double>(), figures["cameras"]["s_te_mm"].get<double>());
  fs::copy_file(folder / "first.h5", folder / "copy.h5");
  ExpectBadInput({"solve", folder / "first.h5", folder / "copy.h5", "-o", folder / "x.h5"},
                 AllOf(HasSubstr("copy.h5"), HasSubstr("given once")));
  EXPECT_EQ(Execute({"solve", folder / "first.h5", folder / "second.h5", "-o", folder / "second.h5"}).exit_code, 2);
}

TEST(Program, ASolutionWhoseDepthIsAGuessEndsWithFour) {
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"simulate", "-o", folder / "far.h5", "--subjects", "1", "--clips", "1", "--activities", "dance",
                     "--seconds", "6", "--fps", "15", "--distance", "300"})
                .exit_code,
            0);
  const auto solve = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"solve", folder / "far.h5", "-o", folder / "solved.h5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Execute(arguments);
  };
  const Outcome guess = solve({"--bootstrap", "factorisation"});
  EXPECT_EQ(guess.exit_code, 4);
  EXPECT_THAT(guess.output, HasSubstr("undecided"));
  EXPECT_THAT(guess.message(), AllOf(HasSubstr("solved.h5 is written, but its 3D poses cannot be believed"),
                                     HasSubstr("--mirror keep"), HasSubstr("--mirror flip")));
  EXPECT_TRUE(ReadDataset(folder / "solved.h5").HasSolved());
  EXPECT_EQ(solve({"--bootstrap", "factorisation", "--mirror", "keep"}).exit_code, 0);
  const Outcome known = solve({"--bootstrap", "starter"});
  EXPECT_EQ(known.exit_code, 0) << "the starter knows which way round people are: " << known.errors;
  EXPECT_THAT(known.output, HasSubstr("undecided"));
}

TEST(Program, ASecondTrainingInTheSameFolderIsRefused) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  std::vector<std::string> arguments = TrainArguments(folder / "data.h5", folder / "run");
  arguments.insert(arguments.end(), {"--epochs", "100000", "--resume"});
  const pid_t first = Start(arguments, folder / "out", folder / "err");
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!fs::exists(folder / "run/metrics.jsonl") && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  for (const char* how : {"--resume", "--overwrite"}) {
    arguments.back() = how;
    ExpectBadInput(arguments, AllOf(HasSubstr("run: expected a folder in which nothing else is at work"),
                                    HasSubstr(fmt::format("found process {} on ", first))));
  }
  kill(first, SIGKILL);
  EXPECT_EQ(Wait(first), 128 + SIGKILL) << "the second one did not disturb it";
  EXPECT_TRUE(fs::exists(folder / "run/lock")) << "what a killed process leaves";
  arguments = TrainArguments(folder / "data.h5", folder / "run");
  arguments.emplace_back("--overwrite");
  EXPECT_TRUE(HasTrained(Execute(arguments)));
  EXPECT_FALSE(fs::exists(folder / "run/lock"));
}

TEST(Program, AFullDiskKeepsWhatWasThere) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  ASSERT_TRUE(HasTrained(Execute(TrainArguments(folder / "data.h5", folder / "run"))));
  const std::string model = ReadFile(folder / "run/model.cpm");
  WriteFileAtomically(folder / "poses.npz", "old");
  WriteFileAtomically(folder / "out.h5", "old");
  // A limit on the size of files makes writing fail as a full disk does.
  const auto with_limit = [&](const std::vector<std::string>& arguments, rlim_t bytes) {
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{bytes, bytes};
      setrlimit(RLIMIT_FSIZE, &limit);
      dup2(open((folder / "err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), STDERR_FILENO);
      Become(arguments);
    }
    const int exit_code = Wait(child);
    return Outcome{exit_code, "", ReadFile(folder / "err")};
  };
  const std::vector<std::vector<std::string>> commands = {
      {"lift", folder / "run", folder / "data.h5", "--camera", "a", "-o", folder / "poses.npz"},
      {"simulate", "-o", folder / "out.h5", "--subjects", "1", "--clips", "1", "--seconds", "1"},
      {"import", "openpose", TestData("detections/openpose"), "-o", folder / "out.h5", "--image-size", "1920x1080"},
      {"train", folder / "data.h5", "-o", folder / "run", "--preset", "plus", "--width", "24", "--epochs", "3",
       "--threads", "1", "--overwrite"}};
  const auto files = [&] { return std::distance(fs::recursive_directory_iterator(folder.path()), {}); };
  for (const std::vector<std::string>& command : commands) {
    for (const rlim_t bytes : {1000, 4000}) {
      const Outcome outcome = with_limit(command, bytes);
      const auto before = files();
      EXPECT_EQ(outcome.exit_code, 3) << command.front() << outcome.errors;
      EXPECT_THAT(outcome.message(), AllOf(::testing::StartsWith("error: "), HasSubstr("free some space")));
      EXPECT_EQ(files(), before);
    }
  }
  EXPECT_EQ(ReadFile(folder / "poses.npz"), "old");
  EXPECT_EQ(ReadFile(folder / "out.h5"), "old");
  EXPECT_EQ(ReadFile(folder / "run/model.cpm"), model);
}

TEST(Program, MessagesAreOneLineWhateverAFileIsCalled) {
  const TemporaryFolder folder;
  for (const char* name : {"two\nlines.h5", "{}.h5", "%s.h5", "ta\tb.h5", "a\rb.h5"}) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"info", folder / name},
          {"solve", folder / name, "-o", folder / "x.h5"},
          {"import", "openpose", TestData("detections/openpose"), "-o", folder / "none" / name, "--image-size", "9x9"},
          {"solve", folder / name, "-o", std::string(name) + ".csv"}}) {
      const Outcome outcome = Execute(arguments);
      EXPECT_THAT(outcome.exit_code, ::testing::AnyOf(2, 3)) << outcome.errors;
      EXPECT_EQ(outcome.errors, outcome.message() + "\n");
    }
  }
}

TEST(Program, SolvesBodiesOtherThanPeoples) {
  const TemporaryFolder folder;
  ASSERT_EQ(Execute({"simulate", "-o", folder / "a.h5", "--subjects", "1", "--activities", "gait,dance", "--seconds",
                     "6", "--fps", "20", "--seed", "4"})
                .exit_code,
            0);
  Dataset beast = ReadDataset(folder / "a.h5");
  for (std::string& joint : beast.skeleton.joints) std::ranges::reverse(joint);  // names of no person's joints
  WriteDataset(folder / "beast.h5", beast);
  const Outcome solved = Execute({"solve", folder / "beast.h5", "-o", folder / "solved.h5"});
  ASSERT_EQ(solved.exit_code, 0) << solved.errors;
  ASSERT_EQ(Execute({"evaluate", folder / "solved.h5", "--json", folder / "figures.json"}).exit_code, 0);
  const auto figures = nlohmann::json::parse(ReadFile(folder / "figures.json"));
  EXPECT_LT(figures["p_mpjpe_mm"].get<double>(), 30.0);
  EXPECT_LT(figures["mirrored_percent"].get<double>(), 2.0);
  EXPECT_EQ(Execute({"solve", folder / "beast.h5", "-o", folder / "x.h5", "--bootstrap", "starter"}).exit_code, 3);
}

TEST(Program, BadInputsOfSimulation) {
  const TemporaryFolder folder;
  const std::string out = folder / "out.h5";
  fs::copy_file(TestData("mocap/tiny.amc"), folder / "lone.amc");
  ExpectBadInput({"simulate", folder / "lone.amc", "-o", out}, AllOf(HasSubstr("lone.amc"), HasSubstr(".asf")));
  std::string bvh = ReadFile(TestData("mocap/tiny.bvh"));
  WriteFileAtomically(folder / "cut.bvh", bvh.substr(0, bvh.find_last_not_of(" \n0123456789.-") + 1) + "\n1 2 3\n");
  ExpectBadInput({"simulate", folder / "cut.bvh", "-o", out}, AllOf(HasSubstr("cut.bvh"), HasSubstr("line")));
  const std::string channels = "CHANNELS 3";
  ASSERT_NE(bvh.find(channels), std::string::npos);
  bvh.replace(bvh.find(channels), channels.size(), "CHANNELS 4");
  WriteFileAtomically(folder / "channel.bvh", bvh);
  ExpectBadInput({"simulate", folder / "channel.bvh", "-o", out}, AllOf(HasSubstr("channel.bvh"), HasSubstr("line")));
  const std::string camera =
      R"({"name":"%","image_size":[100,100],"K":[[90,0,50],[0,90,50],[0,0,1]],"R":[[1,0,0],[0,1,0],[0,0,-1]],"t":[0,0,1]})";
  std::string rig = "{\"cameras\":[" + camera;
  rig += ",";
  rig += camera;
  rig += "]}";
  WriteFileAtomically(folder / "rig.json", rig);
  ExpectBadInput({"simulate", "--rig", folder / "rig.json", "-o", out}, AllOf(HasSubstr("rig.json"), HasSubstr("R")));
  for (const std::string option : {"--subjects", "--clips", "--cameras", "--seconds", "--fps", "--threads"}) {
    ExpectBadInput({"simulate", option, "-2", "-o", out}, HasSubstr(option));
  }
  ExpectBadInput({"simulate", "--subjects", "1", "--clips", "1", "-o", "/proc/out.h5"}, HasSubstr("/proc/out.h5"));
  EXPECT_EQ(Execute({"simulate"}).exit_code, 2);
  EXPECT_EQ(Execute({"simulate", "--activities", "flying", "-o", out}).exit_code, 2);
  EXPECT_FALSE(fs::exists(out));
}

TEST(Program, TrainingPrintsTheSameOnATerminalAndInAPipe) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  const auto train = [&](Output output) {
    std::vector<std::string> arguments = TrainArguments(folder / "data.h5", folder / "run");
    arguments.insert(arguments.end(), {"--epochs", "400", "--overwrite"});
    return SaidTo(
        output, [&] { Become(arguments); }, /*exit_code=*/4);
  };
  const auto masked = [](const std::string& said) {
    // Slow training also leaves a line every few seconds.
    const std::string lines = std::regex_replace(Lasting(said), std::regex(R"(step \d+/[^\n]*\n)"), "");
    return std::regex_replace(lines, std::regex(R"(steps in [^,;]*)"), "steps in TIME");
  };
  const std::string piped = train(Output::kPipe);
  const std::string shown = train(Output::kTerminal);
  EXPECT_THAT(shown, HasSubstr("step ")) << "what a terminal shows in place";
  EXPECT_THAT(masked(shown), Not(HasSubstr("\033")));
  EXPECT_THAT(masked(piped), AllOf(HasSubstr("frames to train on"), HasSubstr("steps in TIME")));
  EXPECT_EQ(masked(shown), masked(piped));
}

TEST(Program, InterruptedTrainingSavesAndSaysHowToContinue) {
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  std::vector<std::string> arguments = TrainArguments(folder / "data.h5", folder / "run");
  arguments.insert(arguments.end(), {"--epochs", "100000"});
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder / "run");
    const pid_t child = Start(arguments, folder / "out", folder / "err");
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (!fs::exists(folder / "run/metrics.jsonl") && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(child, signal);
    EXPECT_EQ(Wait(child), 128 + signal);
    EXPECT_THAT(ReadFile(folder / "err"), HasSubstr("--resume"));
    EXPECT_TRUE(fs::exists(folder / "run/checkpoint.h5"));
    EXPECT_FALSE(fs::exists(folder / "run/model.cpm"));
  }
}

TEST(Program, KilledAtTwentyRandomMomentsAndResumedGivesTheSameBits) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  const TemporaryFolder folder;
  WriteData(folder / "data.h5");
  std::vector<std::string> arguments = TrainArguments(folder / "data.h5", folder / "whole");
  arguments.insert(arguments.end(), {"--epochs", "150", "--seed", "5", "--set", "checkpoint_seconds=0.002"});
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(HasTrained(Execute(arguments)));
  const double whole_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  arguments[3] = folder / "killed";
  arguments.emplace_back("--resume");
  Rng rng(7);
  int kills = 0;
  for (int attempt = 0; kills < 20 && attempt < 200; ++attempt) {
    const pid_t child = Start(arguments, folder / "out", folder / "err");
    std::this_thread::sleep_for(std::chrono::duration<double>(rng.Uniform(0.1, 0.9) * whole_seconds));
    kill(child, SIGKILL);
    if (Wait(child) == 128 + SIGKILL) ++kills;
    // A run that has ended is started afresh, so that every kill hits a running one.
    if (fs::exists(folder / "killed/model.cpm")) {
      EXPECT_EQ(ReadFile(folder / "killed/model.cpm"), ReadFile(folder / "whole/model.cpm"));
      fs::remove_all(folder / "killed");
    }
  }
  const Outcome last = Execute(arguments);
  ASSERT_TRUE(HasTrained(last)) << last.errors;
  EXPECT_EQ(ReadFile(folder / "killed/model.cpm"), ReadFile(folder / "whole/model.cpm"));
  EXPECT_EQ(kills, 20);
}

}  // namespace
}  // namespace canonpose
