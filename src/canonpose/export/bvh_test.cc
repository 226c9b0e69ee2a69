#include "canonpose/export/bvh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/motion_files.h"
#include "canonpose/motion/motion_testing.h"
#include "canonpose/motion/readers/bvh.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;
using testing::ErrorOf;
using testing::PositionsByName;
using testing::Shared;
using testing::TemporaryFolder;

constexpr double kToleranceMm = 0.1;

/// The largest distance between the joints of both, which must have the same names and parents; mm.
double LargestDifference(const ArticulatedMotion& a, const ArticulatedMotion& b) {
  EXPECT_EQ(a.frame_count(), b.frame_count());
  EXPECT_EQ(a.joint_count(), b.joint_count());
  const auto parents = [](const ArticulatedMotion& motion) {
    std::map<std::string, std::string> names;
    for (const MotionJoint& joint : motion.joints) {
      names[joint.name] = joint.parent < 0 ? "" : motion.joints[static_cast<std::size_t>(joint.parent)].name;
    }
    return names;
  };
  EXPECT_EQ(parents(a), parents(b));
  double largest = 0.0;
  for (int t = 0; t < std::min(a.frame_count(), b.frame_count()); ++t) {
    const std::map<std::string, Vector3d> of_b = PositionsByName(b, t);
    for (const auto& [name, position] : PositionsByName(a, t))
      largest = std::max(largest, (position - of_b.at(name)).norm());
  }
  return largest;
}

ArticulatedMotion WriteAndRead(const ArticulatedMotion& motion, double unit_mm) {
  const TemporaryFolder folder;
  WriteBvh(folder / "clip.bvh", motion);
  return ReadBvh(folder / "clip.bvh", unit_mm);
}

/// A chain of 12 joints one metre apart, with side branches and leaves of every kind and random rotations; every third
/// rotation is at or near gimbal lock, where z and y rotate about the same axis.
ArticulatedMotion RandomMotion(int frames) {
  ArticulatedMotion motion;
  motion.fps = 50.0;
  motion.joints.push_back({"root", -1, Vector3d::Zero()});
  for (int i = 1; i < 12; ++i) motion.joints.push_back({fmt::format("link {}", i), i - 1, Vector3d(100, -200, 974.7)});
  motion.joints.push_back({"link 11_end", 11, Vector3d(0, 300, 0)});
  motion.joints.push_back({"leaf", 5, Vector3d(50, 60, 70)});
  motion.joints.push_back({"leaf of nothing", 3, Vector3d::Zero()});
  motion.joints.push_back({"link 4_end", 4, Vector3d(1, 2, 3)});  // not the only child
  motion.joints.push_back({"hand", 2, Vector3d(10, 0, 0)});
  motion.joints.push_back({"hand_end", 16, Vector3d::Zero()});
  motion.joints.push_back({"leaf_end", 1, Vector3d(0, 40, 0)});  // not the end of a joint "leaf"
  Rng rng(5);
  for (int t = 0; t < frames; ++t) {
    motion.root_position_mm.emplace_back(rng.Uniform(-5000, 5000), rng.Uniform(-5000, 5000), rng.Uniform(0, 2000));
    for (int j = 0; j < motion.joint_count(); ++j) {
      Eigen::Quaterniond q(rng.Normal(), rng.Normal(), rng.Normal(), rng.Normal());
      if (rng.Index(3) == 0) {
        const double offset = std::vector<double>{0.0, 1e-9, 1e-7, 1e-5, 1e-3}[rng.Index(5)];
        // In the file's axes, y up, the second rotation is about x.
        const double right_angle = (rng.Index(2) == 0 ? -1 : 1) * (std::numbers::pi / 2 + offset);
        q = Eigen::AngleAxisd(rng.Uniform(-3, 3), -Vector3d::UnitY()) *
            Eigen::AngleAxisd(right_angle, Vector3d::UnitX()) *
            Eigen::AngleAxisd(rng.Uniform(-3, 3), Vector3d::UnitZ());
      }
      motion.parent_from_joint.push_back(q.normalized());
    }
  }
  return motion;
}

TEST(WriteBvh, NamesAndPositionsComeBackEvenDeepInTheTreeAndNearGimbalLock) {
  const ArticulatedMotion motion = RandomMotion(300);
  const ArticulatedMotion read = WriteAndRead(motion, 10.0);
  EXPECT_LT(LargestDifference(motion, read), 0.01);
  EXPECT_EQ(read.fps, 50.0);
}

TEST(WriteBvh, AnglesAreContinuousOverFrames) {
  // Two full turns about the vertical axis, with a tilt that exceeds a right angle on the way.
  ArticulatedMotion motion;
  motion.fps = 100.0;
  motion.joints = {{"root", -1, Vector3d::Zero()}, {"root_end", 0, Vector3d(0, 0, 1700)}};
  constexpr int kFrames = 200;
  for (int t = 0; t < kFrames; ++t) {
    const double turn = 4.0 * std::numbers::pi * t / kFrames;
    motion.root_position_mm.push_back(Vector3d::Zero());
    motion.parent_from_joint.push_back(Eigen::AngleAxisd(turn, Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(0.9 * turn, Vector3d::UnitX()));
    motion.parent_from_joint.push_back(Eigen::Quaterniond::Identity());
  }
  const TemporaryFolder folder;
  WriteBvh(folder / "turn.bvh", motion);
  const std::string text = ReadFile(folder / "turn.bvh");
  std::istringstream rows(text.substr(text.find('\n', text.find("Frame Time")) + 1));
  std::vector<double> before(6, 0.0);
  double reached = 0.0;
  for (int t = 0; t < kFrames; ++t) {
    for (std::size_t i = 0; i < 6; ++i) {
      double value = 0.0;
      ASSERT_TRUE(rows >> value);
      if (i >= 3) {
        EXPECT_LT(std::abs(value - before[i]), 179.0) << "value " << i << " of frame " << t;
        reached = std::max(reached, std::abs(value));
      }
      before[i] = value;
    }
  }
  EXPECT_GT(reached, 181.0);  // so angles are not limited to half a turn
  EXPECT_LT(LargestDifference(motion, ReadBvh(folder / "turn.bvh")), 0.01);
}

TEST(WriteBvh, LeavesTheOldFileWhereItCannotWrite) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { WriteBvh("/nonexistent/a.bvh", RandomMotion(1)); }),
              ::testing::HasSubstr("/nonexistent/a.bvh"));
}

// Compares the two readers: what one reads from a recorded clip, the other reads from the file written from it.
TEST(WriteBvh, RecordedClipsComeBackThroughTheOtherReader) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/cmu");
  const std::vector<std::filesystem::path> files = FindMotionFiles({Shared("data/cmu")});
  ASSERT_FALSE(files.empty());
  for (const std::filesystem::path& file : files) {
    ArticulatedMotion motion = ReadMotion(file);
    // Every 23rd frame, so that the test takes only a second or two.
    std::size_t kept = 0;
    const std::size_t joints = motion.joints.size();
    for (std::size_t t = 0; t < motion.root_position_mm.size(); t += 23, ++kept) {
      motion.root_position_mm[kept] = motion.root_position_mm[t];
      for (std::size_t j = 0; j < joints; ++j) {
        motion.parent_from_joint[kept * joints + j] = motion.parent_from_joint[t * joints + j];
      }
    }
    motion.root_position_mm.resize(kept);
    motion.parent_from_joint.resize(kept * joints);
    const ArticulatedMotion read = WriteAndRead(motion, 0.0);  // which also recognises the unit
    EXPECT_LT(LargestDifference(motion, read), kToleranceMm) << file;
    const LandmarkTrack before = MakeLandmarkTrack(motion, "before");
    const LandmarkTrack after = MakeLandmarkTrack(read, "after");
    for (std::size_t i = 0; i < before.positions_mm.size(); ++i) {
      ASSERT_LT((before.positions_mm[i] - after.positions_mm[i]).norm(), kToleranceMm) << file << " " << i;
    }
  }
}

}  // namespace
}  // namespace canonpose
