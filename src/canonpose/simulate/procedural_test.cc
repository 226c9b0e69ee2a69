#include "canonpose/simulate/procedural.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/simulate/people/body.h"
#include "canonpose/simulate/people/stage.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;

// A clip and the positions of its joints.
struct Played {
  ArticulatedMotion motion;
  std::vector<std::vector<Vector3d>> positions;                   // (T)(J)
  std::vector<std::vector<Eigen::Quaterniond>> world_from_joint;  // (T)(J)

  [[nodiscard]] int frames() const { return motion.frame_count(); }
  [[nodiscard]] const Vector3d& At(int frame, int joint) const {
    return positions[static_cast<std::size_t>(frame)][static_cast<std::size_t>(joint)];
  }
  // The flexion of a joint, from the positions of its neighbours, in degrees; 0 is straight.
  [[nodiscard]] double Bend(int frame, int above, int joint, int below) const {
    const Vector3d upper = (At(frame, joint) - At(frame, above)).normalized();
    const Vector3d lower = (At(frame, below) - At(frame, joint)).normalized();
    return DegFromRad(std::acos(std::clamp(upper.dot(lower), -1.0, 1.0)));
  }
  [[nodiscard]] double Knee(int frame, int side) const {
    return Bend(frame, LegJoint(kBLHip, side), LegJoint(kBLKnee, side), LegJoint(kBLFoot, side));
  }
  [[nodiscard]] Vector3d Velocity(int frame, int joint) const {
    return (At(frame + 1, joint) - At(frame, joint)) * motion.fps / 1000.0;
  }
  // Height of the lowest landmark of a foot, mm.
  [[nodiscard]] double FootHeight(int frame, int side) const {
    return std::min({At(frame, LegJoint(kBLHeel, side)).z(), At(frame, LegJoint(kBLBigToe, side)).z(),
                     At(frame, LegJoint(kBLSmallToe, side)).z()});
  }
  // The body's forward direction, horizontal.
  [[nodiscard]] Vector3d Front(int frame) const {
    const Vector3d left = At(frame, kBLHip) - At(frame, kBRHip);
    return Vector3d(left.y(), -left.x(), 0).normalized();
  }
};

Played Play(Activity activity, std::uint64_t seed, double fps = 50.0, int frames = 500) {
  ProceduralClip clip;
  clip.activity = activity;
  clip.subject_seed = seed;
  clip.motion_seed = 1000 + seed;
  clip.fps = fps;
  clip.frames = frames;
  Played played;
  played.motion = MakeProceduralMotion(clip);
  played.positions.resize(static_cast<std::size_t>(frames));
  played.world_from_joint.resize(static_cast<std::size_t>(frames));
  for (int f = 0; f < frames; ++f) {
    const auto i = static_cast<std::size_t>(f);
    ForwardKinematics(played.motion, f, played.positions[i], played.world_from_joint[i]);
  }
  return played;
}

class EveryActivity : public ::testing::TestWithParam<Activity> {};
INSTANTIATE_TEST_SUITE_P(Procedural, EveryActivity, ::testing::ValuesIn(AllActivities()),
                         [](const auto& test) { return std::string(ActivityName(test.param)); });

TEST(Procedural, NamesActivities) {
  ASSERT_EQ(AllActivities().size(), 10U);
  for (const Activity activity : AllActivities()) EXPECT_EQ(ParseActivity(ActivityName(activity)), activity);
  const std::string message = testing::ErrorOf(ErrorKind::kInvalidArgument, [] { ParseActivity("swim"); });
  EXPECT_NE(message.find("'swim'"), std::string::npos);
  EXPECT_NE(message.find("gait, run, jump"), std::string::npos);
}

TEST_P(EveryActivity, IsTheSameForTheSameSeedsOnly) {
  ProceduralClip clip{GetParam(), 5, 6, 50.0, 120, "clip", "person"};
  const ArticulatedMotion a = MakeProceduralMotion(clip);
  const ArticulatedMotion b = MakeProceduralMotion(clip);
  clip.motion_seed = 7;
  const ArticulatedMotion c = MakeProceduralMotion(clip);
  EXPECT_EQ(a.name, "clip");
  EXPECT_EQ(a.subject, "person");
  ASSERT_EQ(a.frame_count(), 120);
  EXPECT_EQ(a.root_position_mm, b.root_position_mm);
  double difference = 0.0;
  for (std::size_t i = 0; i < a.parent_from_joint.size(); ++i) {
    EXPECT_EQ(a.parent_from_joint[i].coeffs(), b.parent_from_joint[i].coeffs());
    difference = std::max(difference, a.parent_from_joint[i].angularDistance(c.parent_from_joint[i]));
  }
  EXPECT_GT(difference, 0.2);
  // The person is the same in every activity.
  for (std::size_t j = 0; j < a.joints.size(); ++j) EXPECT_EQ(a.joints[j].offset_mm, c.joints[j].offset_mm);
}

TEST_P(EveryActivity, KeepsLengthsAndJointLimits) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Played played = Play(GetParam(), seed);
    for (int f = 0; f < played.frames(); ++f) {
      for (std::size_t j = 1; j < played.motion.joints.size(); ++j) {
        const MotionJoint& joint = played.motion.joints[j];
        const double length = (played.At(f, static_cast<int>(j)) - played.At(f, joint.parent)).norm();
        ASSERT_NEAR(length, joint.offset_mm.norm(), 1e-6 * (1.0 + length)) << joint.name;
      }
      const auto local = [&](int joint) {
        return played.motion.parent_from_joint[static_cast<std::size_t>(f * played.motion.joint_count() + joint)];
      };
      for (const int side : {kLeft, kRight}) {
        // Knees and elbows are hinges about y that bend one way.
        const Eigen::Quaterniond knee = local(LegJoint(kBLKnee, side));
        const Eigen::Quaterniond elbow = local(ArmJoint(kBLElbow, side));
        ASSERT_LT(std::hypot(knee.x(), knee.z()), 1e-9);
        ASSERT_LT(std::hypot(elbow.x(), elbow.z()), 1e-9);
        const double knee_flexion = DegFromRad(2 * std::atan2(knee.y(), knee.w()));
        const double elbow_flexion = DegFromRad(-2 * std::atan2(elbow.y(), elbow.w()));
        ASSERT_GE(knee_flexion, 0.0) << "frame " << f;
        ASSERT_LE(knee_flexion, 149.0) << "frame " << f;
        ASSERT_GE(elbow_flexion, 0.0) << "frame " << f;
        ASSERT_LE(elbow_flexion, 146.0) << "frame " << f;
      }
      for (const int joint : {kBNeck, kBUpperNeck, kBLumbar, kBSpine}) {
        ASSERT_LT(DegFromRad(local(joint).angularDistance(Eigen::Quaterniond::Identity())), 62.0) << "frame " << f;
      }
    }
  }
}

// Metres per second squared.
double LargestAcceleration(const Played& played) {
  double largest = 0.0;
  for (int f = 1; f + 1 < played.frames(); ++f) {
    for (int j = 0; j < kBodyJointCount; ++j) {
      const Vector3d change = played.At(f + 1, j) - 2.0 * played.At(f, j) + played.At(f - 1, j);
      largest = std::max(largest, change.norm() * played.motion.fps * played.motion.fps / 1000.0);
    }
  }
  return largest;
}

TEST_P(EveryActivity, MovesSmoothly) {
  const std::map<Activity, double> limits = {{Activity::kRun, 450.0}, {Activity::kJump, 600.0}, {Activity::kSki, 80.0}};
  const auto found = limits.find(GetParam());
  const double limit = found == limits.end() ? 300.0 : found->second;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    EXPECT_LT(LargestAcceleration(Play(GetParam(), seed)), limit) << "seed " << seed;
    // A jump in velocity would make the acceleration eight times as large at eight times the frame rate.
    EXPECT_LT(LargestAcceleration(Play(GetParam(), seed, 400.0, 3000)), 3.0 * limit) << "seed " << seed;
  }
}

TEST_P(EveryActivity, StaysAboveTheGround) {
  if (GetParam() == Activity::kSki) GTEST_SKIP() << "the slope is not level";
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Played played = Play(GetParam(), seed);
    for (int f = 0; f < played.frames(); ++f) {
      for (int j = 0; j < kBodyJointCount; ++j) {
        ASSERT_GT(played.At(f, j).z(), -30.0)
            << "seed " << seed << " frame " << f << " " << played.motion.joints[static_cast<std::size_t>(j)].name;
      }
    }
  }
}

// The longest distance that an ankle or the ball of a foot moves while the foot stands, which means low and slow for at
// least 0.15 s.
double LargestSlide(const Played& played, int side, int& stances) {
  const int ball = LegJoint(kBLToes, side);
  double largest = 0.0;
  int begin = -1;
  for (int f = 0; f + 1 < played.frames(); ++f) {
    const Vector3d velocity = played.Velocity(f, ball);
    const bool stands = played.At(f, ball).z() < 22.0 && velocity.norm() < 0.35;
    if (stands && begin < 0) begin = f;
    if (stands || begin < 0) continue;
    // The first and last frames of a stance still belong to landing and leaving.
    if (f - begin >= 8) {
      ++stances;
      for (int g = begin + 3; g < f - 3; ++g) {
        largest = std::max(largest, (played.At(g, ball) - played.At(begin + 2, ball)).head<2>().norm());
      }
    }
    begin = -1;
  }
  return largest;
}

TEST_P(EveryActivity, FeetStandStill) {
  if (GetParam() == Activity::kSki) GTEST_SKIP() << "skis slide";
  int stances = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Played played = Play(GetParam(), seed);
    for (const int side : {kLeft, kRight}) {
      EXPECT_LT(LargestSlide(played, side, stances), 25.0) << "seed " << seed << " side " << side;
    }
  }
  EXPECT_GT(stances, 6);
}

double DistanceToSegment(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d axis = to - from;
  const double along = std::clamp((point - from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (point - from - along * axis).norm();
}

TEST_P(EveryActivity, KeepsArmsOutOfTheTrunk) {
  int inside = 0;
  int frames = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Played played = Play(GetParam(), seed);
    const double stature = MakeBody(seed).stature;
    for (int f = 0; f < played.frames(); ++f) {
      ++frames;
      const auto deep = [&](const Vector3d& point, int from, int to, double radius) {
        return DistanceToSegment(point, played.At(f, from), played.At(f, to)) < (radius - 0.008) * stature;
      };
      bool any = false;
      for (const int side : {kLeft, kRight}) {
        const Vector3d& elbow = played.At(f, ArmJoint(kBLElbow, side));
        const Vector3d& wrist = played.At(f, ArmJoint(kBLWrist, side));
        for (const Vector3d& point : {wrist, Vector3d(0.5 * (elbow + wrist)), elbow}) {
          any = any || deep(point, kBLHip, kBLShoulder, 0.050) || deep(point, kBRHip, kBRShoulder, 0.050) ||
                deep(point, kBHip, kBThorax, 0.055);
        }
      }
      inside += any ? 1 : 0;
    }
  }
  EXPECT_LT(inside, 0.01 * frames) << inside << " of " << frames;
}

TEST(Procedural, WalkersWalk) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kGait, seed);
    double way = 0.0;
    int swaps = 0;
    int last = 0;
    double furthest = 0.0;
    for (int f = 0; f + 1 < played.frames(); ++f) {
      way += (played.At(f + 1, kBHip) - played.At(f, kBHip)).head<2>().norm() / 1000.0;
      furthest = std::max(furthest, played.At(f, kBHip).head<2>().norm());
      const double ahead = (played.At(f, kBLFoot) - played.At(f, kBRFoot)).dot(played.Front(f));
      const int sign = ahead > 60.0 ? 1 : (ahead < -60.0 ? -1 : last);
      if (sign != last) ++swaps;
      last = sign;
      // Walking has no flight.
      ASSERT_LT(std::min(played.FootHeight(f, kLeft), played.FootHeight(f, kRight)), 40.0) << seed << " " << f;
    }
    EXPECT_GT(way / 10.0, 0.3) << seed;
    EXPECT_LT(way / 10.0, 2.3) << seed;
    EXPECT_GT(swaps, 5) << seed;
    EXPECT_LT(furthest, 3500.0) << seed;
  }
}

TEST(Procedural, RunnersFly) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kRun, seed);
    int flying = 0;
    double way = 0.0;
    double furthest = 0.0;
    for (int f = 0; f + 1 < played.frames(); ++f) {
      furthest = std::max(furthest, played.At(f, kBHip).head<2>().norm());
      way += (played.At(f + 1, kBHip) - played.At(f, kBHip)).head<2>().norm() / 1000.0;
      flying += std::min(played.FootHeight(f, kLeft), played.FootHeight(f, kRight)) > 25.0 ? 1 : 0;
    }
    EXPECT_GT(way / 10.0, 1.3) << seed;
    EXPECT_LT(way / 10.0, 5.5) << seed;
    EXPECT_GT(flying, 8) << seed;
    EXPECT_LT(furthest, 4000.0) << seed << ": out of the room";
  }
}

TEST(Procedural, JumpersLeaveTheGround) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kJump, seed);
    double highest = 0.0;
    for (int f = 0; f < played.frames(); ++f) {
      highest = std::max(highest, std::min(played.FootHeight(f, kLeft), played.FootHeight(f, kRight)));
    }
    EXPECT_GT(highest, 60.0) << seed;
  }
}

TEST(Procedural, SquattersBendTheirKnees) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kSquat, seed);
    double knee = 0.0;
    double lowest = 1e9;
    double highest = 0.0;
    for (int f = 0; f < played.frames(); ++f) {
      knee = std::max(knee, std::min(played.Knee(f, kLeft), played.Knee(f, kRight)));
      lowest = std::min(lowest, played.At(f, kBHip).z());
      highest = std::max(highest, played.At(f, kBHip).z());
    }
    EXPECT_GT(knee, 80.0) << seed;
    EXPECT_LT(lowest, 0.8 * highest) << seed;
  }
}

TEST(Procedural, SittersBendTheirHips) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kSit, seed);
    int seated = 0;
    for (int f = 0; f < played.frames(); ++f) {
      const Vector3d trunk = played.At(f, kBThorax) - played.At(f, kBHip);
      const Vector3d thigh = played.At(f, kBLKnee) - played.At(f, kBLHip);
      const double hip = 180.0 - DegFromRad(std::acos(trunk.normalized().dot(thigh.normalized())));
      seated += hip > 55.0 && played.At(f, kBHip).z() < 0.42 * MakeBody(seed).stature ? 1 : 0;
    }
    EXPECT_GT(seated, 100) << seed;
  }
}

TEST(Procedural, ReachersReachAndBend) {
  double highest = 0.0;
  double lowest = 1.0;
  double deepest_bend = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Played played = Play(Activity::kReach, seed);
    const double stature = MakeBody(seed).stature;
    for (int f = 0; f < played.frames(); ++f) {
      for (const int side : {kLeft, kRight}) {
        const double height = played.At(f, ArmJoint(kBLWrist, side)).z() / stature;
        highest = std::max(highest, height);
        lowest = std::min(lowest, height);
      }
      const Vector3d trunk = (played.At(f, kBThorax) - played.At(f, kBHip)).normalized();
      deepest_bend = std::max(deepest_bend, DegFromRad(std::acos(trunk.z())));
    }
  }
  EXPECT_GT(highest, 1.08);
  EXPECT_LT(lowest, 0.12);
  EXPECT_GT(deepest_bend, 60.0);
}

TEST(Procedural, ThrowersAreFast) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kThrow, seed);
    double fastest = 0.0;
    for (int f = 0; f + 1 < played.frames(); ++f) {
      for (const int joint : {kBLWrist, kBRWrist}) fastest = std::max(fastest, played.Velocity(f, joint).norm());
    }
    EXPECT_GT(fastest, 5.0) << seed;
    EXPECT_LT(fastest, 25.0) << seed;
  }
}

TEST(Procedural, GesturesAndDancesCoverTheArmsRange) {
  for (const Activity activity : {Activity::kGesture, Activity::kDance}) {
    int raised = 0;
    int across = 0;
    int frames = 0;
    double one_leg = 0.0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Played played = Play(activity, seed);
      for (int f = 0; f < played.frames(); ++f) {
        ++frames;
        const double head = played.At(f, kBHead).z();
        raised += played.At(f, kBLWrist).z() > head || played.At(f, kBRWrist).z() > head ? 1 : 0;
        const Vector3d left = played.At(f, kBLShoulder) - played.At(f, kBRShoulder);
        const Vector3d wrist = played.At(f, kBLWrist) - played.At(f, kBThorax);
        across += wrist.dot(left) < 0.0 ? 1 : 0;
        const double lifted = std::max(played.FootHeight(f, kLeft), played.FootHeight(f, kRight));
        one_leg += lifted > 250.0 ? 1 : 0;
      }
    }
    EXPECT_GT(raised, 0.05 * frames) << ActivityName(activity);
    EXPECT_GT(across, 0.015 * frames) << ActivityName(activity);
    if (activity == Activity::kDance) {
      EXPECT_GT(one_leg, 0.08 * frames);
    }
  }
}

TEST(Procedural, SkiersLeanIntoTheirTurns) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Played played = Play(Activity::kSki, seed);
    double left = 0.0;
    double right = 0.0;
    int agrees = 0;
    int leaning_frames = 0;
    for (int f = 10; f + 10 < played.frames(); ++f) {
      const Vector3d feet = 0.5 * (played.At(f, kBLFoot) + played.At(f, kBRFoot));
      const Vector3d legs = (played.At(f, kBHip) - feet).normalized();
      const Vector3d way = played.At(f + 10, kBLFoot) - played.At(f - 10, kBLFoot);
      const Vector3d to_left = Vector3d(-way.y(), way.x(), 0).normalized();
      const double lean = DegFromRad(std::asin(legs.dot(to_left)));
      left = std::max(left, lean);
      right = std::min(right, lean);
      const Vector3d before = played.At(f, kBLFoot) - played.At(f - 10, kBLFoot);
      const Vector3d after = played.At(f + 10, kBLFoot) - played.At(f, kBLFoot);
      const double turn = (after - before).dot(to_left);
      if (std::abs(lean) > 25.0) {
        ++leaning_frames;
        agrees += (turn > 0.0) == (lean > 0.0) ? 1 : 0;
        const int inner = lean > 0.0 ? kLeft : kRight;
        EXPECT_GT(played.Knee(f, inner), played.Knee(f, 1 - inner)) << "seed " << seed << " frame " << f;
      }
      EXPECT_GT(std::max(played.Knee(f, kLeft), played.Knee(f, kRight)), 50.0) << seed << " " << f;
    }
    EXPECT_GT(left, 30.0) << seed;
    EXPECT_LT(right, -30.0) << seed;
    EXPECT_LT(std::max(left, -right), 68.0) << seed;
    EXPECT_GT(agrees, 0.97 * leaning_frames) << seed;
  }
}

}  // namespace
}  // namespace canonpose
