#include "canonpose/solve/diagnosis.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/solver.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

SimulationOptions OneClip() {
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  options.seconds = 4.0;
  return options;
}

/// The message of Solve() for a dataset of which nothing can be solved.
std::string FailureOf(Dataset dataset) {
  return ErrorOf(ErrorKind::kComputation, [&] { Solve(dataset, testing::NoisyTruth(dataset), {}); });
}

TEST(Failures, OneCamera) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  dataset.sequences[0].cameras.resize(1);
  EXPECT_THAT(FailureOf(dataset), HasSubstr("needs at least two cameras, has 1"));
}

TEST(Failures, NeverTwoCamerasAtATime) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  Sequence& sequence = dataset.sequences[0];
  sequence.cameras.resize(2);
  const std::size_t half = sequence.cameras[0].confidence.size() / 2;
  std::fill(sequence.cameras[0].confidence.begin(), sequence.cameras[0].confidence.begin() + static_cast<long>(half),
            0.0F);
  std::fill(sequence.cameras[1].confidence.begin() + static_cast<long>(half), sequence.cameras[1].confidence.end(),
            0.0F);
  EXPECT_THAT(FailureOf(dataset), HasSubstr("no two cameras see the person at the same time"));
}

TEST(Failures, TooFewFrames) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  KeepFrames(dataset, {0, 2}, "data.h5");
  EXPECT_THAT(FailureOf(dataset), AllOf(HasSubstr("at least 10 frames"), HasSubstr("has 3")));
}

TEST(Failures, APersonLikeAStatue) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  for (CameraView& view : dataset.sequences[0].cameras) {
    // The person does not move but keypoints still have errors: the first pose plus noise of half a percent of the
    // stature.
    const std::size_t joints = static_cast<std::size_t>(dataset.skeleton.joint_count());
    Rng rng(1, {view.name.size()});
    for (std::size_t i = joints; i < view.confidence.size(); ++i) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        view.keypoints[2 * i + axis] = view.keypoints[2 * (i % joints) + axis] + static_cast<float>(1.5 * rng.Normal());
      }
      view.confidence[i] = view.confidence[i % joints];
    }
  }
  EXPECT_THAT(FailureOf(dataset), AllOf(HasSubstr("the person hardly moves in these"),
                                        HasSubstr("points to find cameras: record somebody who moves")));
  KeepFrames(dataset, {0, 11}, "data.h5");
  EXPECT_THAT(FailureOf(dataset), AllOf(HasSubstr("hardly moves in these 12 frames"), HasSubstr("give more frames")));
}

TEST(Failures, TheSameViewTwice) {
  SimulationOptions options = OneClip();
  options.rig.cameras = 2;
  Dataset dataset = testing::Simulate(options).dataset;
  Sequence& sequence = dataset.sequences[0];
  const std::string name = sequence.cameras[1].name;
  sequence.cameras[1] = sequence.cameras[0];
  sequence.cameras[1].name = name;
  EXPECT_THAT(FailureOf(dataset), HasSubstr("look along nearly the same line"));
}

TEST(Failures, TwoCamerasThatShowDifferentPeople) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = OneClip();
  options.rig.cameras = 2;
  options.rig.spread = "quarter";
  options.seconds = 15.0;
  Dataset dataset = testing::Simulate(options).dataset;
  options.seed = 53;
  options.activities = {Activity::kThrow};
  dataset.sequences[0].cameras[1] = testing::Simulate(options).dataset.sequences[0].cameras[1];
  EXPECT_THAT(FailureOf(dataset), HasSubstr("cameras do not agree"));
}

TEST(Failures, PosesToStartFromThatContradictTheKeypoints) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  StartPoses upside_down = testing::NoisyTruth(dataset);
  for (PoseSequence& view : upside_down.sequences[0]) {
    for (int t = 0; t < view.frame_count(); ++t) view.PoseAt(t).leftCols<2>() *= -1.0F;
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { Solve(dataset, upside_down, {}); }),
              AllOf(HasSubstr("the cameras could not be found"), HasSubstr("contradict the keypoints in every frame")));
}

TEST(Failures, OneOfTwoCapturesIsInTheReport) {
  Dataset dataset = testing::Simulate(OneClip()).dataset;
  Sequence broken = dataset.sequences[0];
  broken.name = "broken";
  broken.capture = "other cameras";
  broken.cameras.resize(1);
  dataset.sequences.push_back(broken);
  const SolveReport report = Solve(dataset, testing::NoisyTruth(dataset), {});
  ASSERT_THAT(report.captures, SizeIs(2));
  EXPECT_THAT(report.captures[0].failure, IsEmpty());
  EXPECT_THAT(report.captures[1].failure, HasSubstr("two cameras"));
  EXPECT_THAT(report.ToText(), HasSubstr("not solved: needs at least two cameras"));
  const PoseSequence& solved = dataset.sequences[1].cameras[0].solved;
  EXPECT_EQ(solved.frame_count(), broken.frame_count);
  EXPECT_FALSE(solved.AnyKnown());
}

TEST(Implausible, NamesWhatIsWrong) {
  const Plausibility good{0.004, 80.0, 1.0, 0.06, 0.03};
  EXPECT_THAT(Implausible(good), IsEmpty());
  EXPECT_THAT(Doubtful(good), IsEmpty());
  EXPECT_THAT(Doubtful({0.007, 80.0, 1.0, 0.12, 0.03}), HasSubstr("agree poorly"));
  const auto with = [&](auto member, double value) {
    Plausibility bad = good;
    bad.*member = value;
    return Implausible(bad);
  };
  EXPECT_THAT(with(&Plausibility::reprojection, 0.05), HasSubstr("5.0 %"));
  EXPECT_THAT(with(&Plausibility::bone_scatter, 0.4), HasSubstr("bones by 40 %"));
  EXPECT_THAT(with(&Plausibility::reprojection, std::nan("")), HasSubstr("no frame"));
  EXPECT_THAT(with(&Plausibility::view_angle_deg, 4.0), HasSubstr("4 degrees"));
  EXPECT_THAT(with(&Plausibility::depth_over_width, 2.5), HasSubstr("2.5 times as deep as wide"));
  EXPECT_THAT(with(&Plausibility::asymmetry, std::log(1.4)), HasSubstr("40 %"));
}

TEST(MotionSpread, OfEveryActivityIsFarAboveThatOfAStatue) {
  SimulationOptions options = testing::SmallSimulation();
  options.activities = AllActivities();
  options.clips = static_cast<int>(AllActivities().size());
  options.seconds = 4.0;
  for (const Sequence& sequence : testing::Simulate(options).dataset.sequences) {
    Dataset one;
    one.skeleton = *FindSkeleton("h36m-17");
    one.sequences = {sequence};
    EXPECT_GT(MotionSpread(CollectCaptures(one, testing::NoisyTruth(one)).front()), 0.3) << sequence.name;
  }
}

}  // namespace
}  // namespace canonpose
