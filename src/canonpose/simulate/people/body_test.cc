#include "canonpose/simulate/people/body.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "canonpose/motion/landmarks.h"

namespace canonpose {
namespace {

int FindJoint(const Body& body, const std::string& name) {
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    if (body.joints[j].name == name) return static_cast<int>(j);
  }
  return -1;
}

TEST(Body, HasEveryLandmark) {
  const Body body = MakeBody(3);
  ASSERT_EQ(body.joints.size(), static_cast<std::size_t>(kBodyJointCount));
  for (const std::string& name : LandmarkSkeleton().joints) EXPECT_GE(FindJoint(body, name), 0) << name;
  for (std::size_t j = 1; j < body.joints.size(); ++j) {
    EXPECT_GE(body.joints[j].parent, 0);
    EXPECT_LT(body.joints[j].parent, static_cast<int>(j));
  }
}

TEST(Body, IsTheSameForTheSameSeed) {
  const Body a = MakeBody(11);
  const Body b = MakeBody(11);
  const Body c = MakeBody(12);
  bool differs = false;
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    EXPECT_EQ(a.joints[j].offset_mm, b.joints[j].offset_mm);
    differs = differs || a.joints[j].offset_mm != c.joints[j].offset_mm;
  }
  EXPECT_TRUE(differs);
}

TEST(Body, StandsAsTallAsItsStature) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Body body = MakeBody(seed);
    ArticulatedMotion motion;
    motion.joints = body.joints;
    const std::vector<Eigen::Vector3d> rest = RestPose(motion);
    std::vector<Eigen::Vector3d> landmarks;
    for (const std::string& name : LandmarkSkeleton().joints) {
      landmarks.push_back(rest[static_cast<std::size_t>(FindJoint(body, name))]);
    }
    EXPECT_NEAR(StatureMm(landmarks.data()) / body.stature, 1.0, 0.06) << seed;
    const double crown = landmarks[kHead].z() + body.standing_hip_height();
    EXPECT_NEAR(crown / body.stature, 1.0, 0.06) << seed;
    // Hip is the middle of the hips, Thorax of the shoulders.
    EXPECT_LT((landmarks[kLHip] + landmarks[kRHip]).norm() / 2, 1e-9);
    EXPECT_LT(((landmarks[kLShoulder] + landmarks[kRShoulder]) / 2 - landmarks[kThorax]).norm(), 1e-9);
  }
}

TEST(Body, ProportionsAreThoseOfPeople) {
  double smallest = 1e9;
  double largest = 0.0;
  double largest_asymmetry = 0.0;
  std::set<double> leg_shares;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Body body = MakeBody(seed);
    smallest = std::min(smallest, body.stature);
    largest = std::max(largest, body.stature);
    const auto within = [&](double length, double low, double high) {
      EXPECT_GT(length / body.stature, low) << seed;
      EXPECT_LT(length / body.stature, high) << seed;
    };
    for (const int side : {kLeft, kRight}) {
      within(body.thigh[Body::Index(side)], 0.215, 0.275);
      within(body.shank[Body::Index(side)], 0.215, 0.275);
      within(body.upper_arm[Body::Index(side)], 0.150, 0.205);
      within(body.forearm[Body::Index(side)], 0.125, 0.175);
    }
    within(body.hip_width, 0.075, 0.130);
    within(body.shoulder_width, 0.175, 0.260);
    within(body.trunk, 0.255, 0.325);
    leg_shares.insert(body.leg(kLeft) / body.stature);
    for (const auto& pair : {body.thigh, body.shank, body.upper_arm, body.forearm}) {
      largest_asymmetry = std::max(largest_asymmetry, std::abs(pair[0] / pair[1] - 1.0));
    }
  }
  EXPECT_GT(smallest, 1250.0);
  EXPECT_LT(smallest, 1500.0);
  EXPECT_GT(largest, 1900.0);
  EXPECT_LT(largest, 2060.0);
  EXPECT_GT(largest_asymmetry, 0.005);
  EXPECT_LT(largest_asymmetry, 0.03);
  EXPECT_GT(*leg_shares.rbegin() - *leg_shares.begin(), 0.05);
}

}  // namespace
}  // namespace canonpose
