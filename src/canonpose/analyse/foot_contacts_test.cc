#include "canonpose/analyse/foot_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/landmarks.h"
#include "canonpose/simulate/procedural.h"

namespace canonpose {
namespace {

constexpr double kFps = 100.0;
constexpr int kStance = 60;
constexpr int kSwing = 40;

/// Two feet that walk: each stands for 60 frames and swings for 40 over a step of 1.4 m; the left half a cycle later.
/// A leg is 800 mm long, an ankle 80 mm above the floor.
PoseSequence Walker(int frames) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  PoseSequence person(skeleton, frames);
  person.fps = kFps;
  person.unit = LengthUnit::kMillimetres;
  for (int t = 0; t < frames; ++t) {
    for (const bool is_left : {false, true}) {
      const int shifted = t + (is_left ? (kStance + kSwing) / 2 : 0);
      const int step = shifted / (kStance + kSwing);
      const int phase = shifted % (kStance + kSwing);
      double x = 1400.0 * step;
      double z = 80.0;
      if (phase >= kStance) {
        const double part = static_cast<double>(phase - kStance) / kSwing;
        x += 1400.0 * (part - std::sin(2.0 * std::numbers::pi * part) / (2.0 * std::numbers::pi));
        z += 60.0 * (1.0 - std::cos(2.0 * std::numbers::pi * part));
      }
      const auto put = [&](const char* joint, double height) {
        person.PoseAt(t).row(skeleton.Find(std::string(is_left ? "L" : "R") + joint).value()) =
            Eigen::RowVector3f(static_cast<float>(x), is_left ? 100.0F : -100.0F, static_cast<float>(z + height));
      };
      put("Foot", 0.0);
      put("Knee", 400.0);
      put("Hip", 800.0);
    }
  }
  person.TrustKnownJoints();
  return person;
}

std::vector<FootContact> Contacts(const PoseSequence& person) {
  return FindFootContacts(person, FindBodyJoints(person));
}

TEST(FootContacts, AreTheStancesOfAWalker) {
  const std::vector<FootContact> contacts = Contacts(Walker(400));
  // Right: 0-59, 100-159, ...; left: 0-9, 50-109, 150-209, ...
  ASSERT_EQ(contacts.size(), 9U);
  for (std::size_t i = 2; i < 8; ++i) {
    const FootContact& contact = contacts[i];
    EXPECT_EQ(contact.is_left, i % 2 == 0) << i;
    const int first = 50 * (static_cast<int>(i) - 1);
    // The foot is still slow when it lifts and lands.
    EXPECT_NEAR(contact.first_frame, first, 8) << i;
    EXPECT_NEAR(contact.last_frame, first + kStance - 1, 8) << i;
    EXPECT_LE(contact.first_frame, first + 1) << i;
    EXPECT_GE(contact.last_frame, first + kStance - 2) << i;
  }
}

TEST(FootContacts, DoNotDependOnTheUnit) {
  PoseSequence person = Walker(300);
  const std::vector<FootContact> before = Contacts(person);
  for (float& value : person.positions()) value *= 0.0007F;
  person.unit = LengthUnit::kBodyLengths;
  const std::vector<FootContact> after = Contacts(person);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i].first_frame, before[i].first_frame) << i;
}

TEST(FootContacts, EndWhereTheFootIsUnknownForLong) {
  PoseSequence person = Walker(300);
  const int foot = person.skeleton().Find("RFoot").value();
  for (int t = 120; t < 140; ++t) person.PoseAt(t).row(foot).setConstant(std::nanf(""));
  person.PoseAt(210).row(foot).setConstant(std::nanf(""));  // a single frame does not count
  std::vector<FootContact> right = Contacts(person);
  std::erase_if(right, [](const FootContact& contact) { return contact.is_left; });
  ASSERT_EQ(right.size(), 4U);
  EXPECT_EQ(right[1].last_frame, 119);
  EXPECT_EQ(right[2].first_frame, 140);
  EXPECT_LE(right[3].first_frame, 201);
}

TEST(FootContacts, AFootInTheAirStandsNowhere) {
  PoseSequence person = Walker(200);
  for (int t = 0; t < 200; ++t) person.PoseAt(t).col(2).array() += 500.0F;
  EXPECT_TRUE(Contacts(person).empty());
}

TEST(FootContacts, NeedAFrameRate) {
  PoseSequence person = Walker(200);
  person.fps = 0.0;
  EXPECT_TRUE(Contacts(person).empty());
}

/// Simulated people who walk have a foot on the floor nearly always, and each foot for 50 to 80 % of the time.
TEST(FootContacts, OfSimulatedWalking) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    ProceduralClip clip;
    clip.subject_seed = clip.motion_seed = seed;
    const LandmarkTrack track = MakeLandmarkTrack(MakeProceduralMotion(clip), "clip");
    std::vector<float> positions;
    for (const Eigen::Vector3d& at : track.positions_mm) {
      for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(at[k]));
    }
    PoseSequence person(LandmarkSkeleton(), std::move(positions));
    person.fps = clip.fps;
    const auto frame_count = static_cast<std::size_t>(person.frame_count());
    std::vector<int> feet(frame_count, 0);  // on the floor
    std::array<int, 2> stands{};            // frames of right and left
    for (const FootContact& contact : Contacts(person)) {
      for (int t = contact.first_frame; t <= contact.last_frame; ++t) ++feet[static_cast<std::size_t>(t)];
      stands.at(contact.is_left ? 1 : 0) += contact.last_frame - contact.first_frame + 1;
    }
    EXPECT_LT(std::ranges::count(feet, 0), 0.03 * person.frame_count()) << seed;
    EXPECT_EQ(std::ranges::count(feet, 3), 0) << seed;
    for (const int frames : stands) {
      EXPECT_GT(frames, 0.5 * person.frame_count()) << seed;
      EXPECT_LT(frames, 0.8 * person.frame_count()) << seed;
    }
  }
}

}  // namespace
}  // namespace canonpose
