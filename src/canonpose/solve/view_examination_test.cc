#include "canonpose/solve/view_examination.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kFrames = 150;
constexpr int kView = 2;
constexpr double kScatter = 0.003;

/// A rig with errors of the usual size; view kView is to be damaged.
class AView : public ::testing::TestWithParam<bool> {
 protected:
  AView() {
    testing::ExactRigOptions options;
    options.static_cameras = GetParam();
    options.frames = kFrames;
    rig_ = testing::MakeExactRig(options);
    testing::SeeJoints(rig_.truth, kScatter, 3, rig_.capture);
    recorded_ = rig_.capture;
  }

  /// Frame t of the view becomes what it recorded in frame source(t); nothing where that is outside of the clip.
  template <typename Source>
  void Take(Source&& source) {
    testing::TakeFrames(recorded_, kView, source, rig_.capture);
  }
  template <typename Change>
  void ChangeKeypoints(int first, int end, Change&& change) {
    for (int t = first; t < end; ++t) {
      for (int j = 0; j < rig_.capture.joint_count(); ++j) {
        const std::size_t i = 2 * rig_.capture.Index(t, kView, j);
        const Eigen::Vector2d changed = change(t, j, Eigen::Vector2d(rig_.capture.xy[i], rig_.capture.xy[i + 1]));
        rig_.capture.xy[i] = static_cast<float>(changed.x());
        rig_.capture.xy[i + 1] = static_cast<float>(changed.y());
      }
    }
  }
  /// Against the motion that the other views show.
  [[nodiscard]] ViewExamination Examine() const {
    CaptureObservations others = recorded_;
    DropFrames(kView, 0, kFrames, others);
    Solution solution;
    solution.estimate = rig_.truth;
    return ExamineView(rig_.capture, 0, kView, KnownMotion(others, solution, 0), 0.1, kScatter);
  }

  testing::ExactRig rig_;
  CaptureObservations recorded_;
};

INSTANTIATE_TEST_SUITE_P(OfARig, AView, ::testing::Values(true, false),
                         [](const auto& instance) { return instance.param ? "Static" : "Moving"; });

TEST_P(AView, ThatIsAsItShouldBeFits) {
  const ViewExamination found = Examine();
  EXPECT_TRUE(found.fits);
  EXPECT_TRUE(found.reading.IsIdentity());
  EXPECT_THAT(found.bad, IsEmpty());
  EXPECT_LT(found.error, 0.01);
}

TEST_P(AView, ThatRunsBackwardsIsFound) {
  Take([](int t) { return kFrames - 1 - t; });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  EXPECT_EQ(found.reading.time.rate, -1.0);
  EXPECT_NEAR(found.reading.time.offset, kFrames - 1, 1.0);
}

TEST_P(AView, ThatIsLateIsFound) {
  Take([](int t) { return t + 30; });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  EXPECT_EQ(found.reading.time.rate, 1.0);
  EXPECT_NEAR(found.reading.time.offset, 30.0, 1.0);
}

TEST_P(AView, OfHalfTheRateIsFound) {
  Take([](int t) { return 2 * t; });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  EXPECT_EQ(found.reading.time.rate, 2.0);
  EXPECT_NEAR(found.reading.time.offset, 0.0, 2.0);
}

TEST_P(AView, ThatIsMirroredIsFound) {
  const CaptureObservations before = rig_.capture;
  ChangeKeypoints(0, kFrames, [&](int t, int j, const Eigen::Vector2d&) {
    const Eigen::Vector2d other = before.At(t, kView, before.skeleton.mirror[static_cast<std::size_t>(j)]);
    return Eigen::Vector2d(-other.x(), other.y());
  });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  EXPECT_TRUE(found.reading.is_mirrored);
  EXPECT_TRUE(found.reading.sides_are_exchanged);
  EXPECT_TRUE(found.reading.time.IsIdentity());
}

TEST_P(AView, OfSomebodyElseForAWhileIsLeftOutForThatWhile) {
  testing::ExactRigOptions options;
  options.static_cameras = GetParam();
  options.frames = 2 * kFrames;
  const testing::ExactRig later = testing::MakeExactRig(options);
  // The others show this motion with the joints' names in another order: another body.
  ChangeKeypoints(60, 110, [&](int t, int j, const Eigen::Vector2d&) {
    return later.capture.At(t + 90, kView, (j + 5) % later.capture.joint_count());
  });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  EXPECT_TRUE(found.reading.IsIdentity());
  ASSERT_THAT(found.bad, SizeIs(1));
  EXPECT_EQ(found.bad[0].fault, StretchFault::kOther);
  EXPECT_NEAR(found.bad[0].first, 60, 3);
  EXPECT_NEAR(found.bad[0].first + found.bad[0].count, 110, 3);
}

TEST_P(AView, ThatLostFramesIsFound) {
  Take([](int t) { return t < 80 ? t : t + 25; });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  ASSERT_THAT(found.bad, SizeIs(1));
  EXPECT_EQ(found.bad[0].fault, StretchFault::kTimeJump);
  EXPECT_NEAR(found.bad[0].first, 80, 3);
  EXPECT_NEAR(found.bad[0].jump_frames, 25, 1);
}

TEST_P(AView, OfAMotionThatRepeatsItselfIsLeftOutWhereFramesWereLost) {
  // Steps of 20 frames from frame 60 on: 10 lost frames, or 30, or 50?
  for (int t = 80; t < kFrames; ++t) {
    for (int j = 0; j < rig_.truth.joint_count; ++j) rig_.truth.Joint(t, j) = rig_.truth.Joint(t - 20, j);
  }
  testing::SeeJoints(rig_.truth, kScatter, 3, rig_.capture);
  recorded_ = rig_.capture;
  Take([](int t) { return t < 80 ? t : t + 10; });
  const ViewExamination found = Examine();
  ASSERT_TRUE(found.fits);
  ASSERT_THAT(found.bad, Not(IsEmpty()));
  for (const BadStretch& stretch : found.bad) EXPECT_EQ(stretch.fault, StretchFault::kOther);
}

/// What is found about a static view whose camera stands otherwise in the frames first .. end - 1.
ViewExamination ExaminePushed(int first, int end) {
  testing::ExactRigOptions options;
  options.frames = kFrames;
  testing::ExactRig rig = testing::MakeExactRig(options);
  testing::SeeJoints(rig.truth, kScatter, 3, rig.capture);
  CaptureObservations others = rig.capture;
  DropFrames(kView, 0, kFrames, others);
  RigEstimate pushed = rig.truth;
  CameraEstimate& camera = pushed.CameraAt(0, kView);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.SetRotation(turn * camera.Rotation());
  auto translation = Eigen::Vector3d::Map(camera.placement.data());
  translation = (turn * translation).eval();
  CaptureObservations seen_pushed = rig.capture;
  testing::SeeJoints(pushed, kScatter, 4, seen_pushed);
  CaptureObservations both = rig.capture;
  for (int n = first; n < end; ++n) {
    for (int j = 0; j < both.joint_count(); ++j) {
      const std::size_t i = 2 * both.Index(n, kView, j);
      std::copy_n(&seen_pushed.xy[i], 2, &both.xy[i]);
    }
  }
  Solution solution;
  solution.estimate = rig.truth;
  return ExamineView(both, 0, kView, KnownMotion(others, solution, 0), 0.1, kScatter);
}

TEST(AStaticView, ThatWasPushedIsFound) {
  const ViewExamination found = ExaminePushed(90, kFrames);
  ASSERT_TRUE(found.fits);
  EXPECT_TRUE(found.reading.IsIdentity());
  ASSERT_THAT(found.bad, SizeIs(1));
  EXPECT_EQ(found.bad[0].fault, StretchFault::kCameraMoved);
  EXPECT_NEAR(found.bad[0].first, 90, 3);
  EXPECT_EQ(found.bad[0].first + found.bad[0].count, kFrames);
}

TEST(AStaticView, ThatDoesNotFitForAWhileWasNotPushed) {
  const ViewExamination found = ExaminePushed(50, 90);
  ASSERT_TRUE(found.fits);
  ASSERT_THAT(found.bad, SizeIs(1));
  EXPECT_EQ(found.bad[0].fault, StretchFault::kOther);
  EXPECT_NEAR(found.bad[0].first, 50, 3);
}

TEST(ViewCorrection, MovesFramesToTheTimeOfTheOthers) {
  ViewCorrection correction;
  correction.reading.time = {2.0, 3.0};
  correction.offset_frames = -1;
  correction.bad = {{10, 5, StretchFault::kOther, 0}, {20, 5, StretchFault::kTimeJump, 7}};
  EXPECT_EQ(correction.TimeOf(0), 2.0);
  EXPECT_EQ(correction.TimeOf(9), 20.0);
  EXPECT_TRUE(std::isnan(correction.TimeOf(10)));
  EXPECT_TRUE(std::isnan(correction.TimeOf(14)));
  EXPECT_EQ(correction.TimeOf(15), 32.0);
  EXPECT_EQ(correction.TimeOf(20), 49.0);
}

TEST(ViewCorrection, ReadsAMirroredViewAsItWas) {
  const testing::ExactRig rig = testing::MakeExactRig();
  ViewCorrection correction;
  correction.reading.is_mirrored = true;
  correction.reading.sides_are_exchanged = true;
  CaptureObservations twice = rig.capture;
  ApplyCorrection(correction, 0, kView, twice);
  EXPECT_NE(twice.xy, rig.capture.xy);
  ApplyCorrection(correction, 0, kView, twice);
  EXPECT_EQ(twice.xy, rig.capture.xy);
  EXPECT_EQ(twice.start, rig.capture.start);
}

TEST(ViewCorrection, IsDescribedInWords) {
  ViewReading reading;
  EXPECT_EQ(Describe(reading, 25.0), "");
  reading.is_mirrored = true;
  EXPECT_EQ(Describe(reading, 25.0), "is mirrored");
  reading.time.offset = 50.0;
  EXPECT_EQ(Describe(reading, 25.0), "is mirrored and started 50 frames (2.00 s) after the others");
  reading = {};
  reading.time.rate = 2.0;
  EXPECT_EQ(Describe(reading, 25.0), "has 0.5 times the frame rate of the others");
}

}  // namespace
}  // namespace canonpose
