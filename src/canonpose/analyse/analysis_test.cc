#include "canonpose/analyse/analysis.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/analyse/figure_testing.h"

namespace canonpose {
namespace {

using testing::Moving;

double Value(const std::vector<TimeSeries>& series, const std::string& name, std::size_t frame = 0) {
  const TimeSeries* found = FindSeries(series, name);
  EXPECT_NE(found, nullptr) << name;
  return found == nullptr ? std::nan("") : found->values.at(frame);
}

TEST(Analyse, MeasuresSegmentsInTheUnitOfThePoses) {
  PoseSequence person = Moving({{{"hip_flexion_r", 40}, {"knee_angle_r", 80}}});
  const Analysis analysis = Analyse(person, true);
  EXPECT_NEAR(Value(analysis.segment_lengths, "pelvis_width"), 200, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "trunk_length"), 500, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "shoulder_width"), 340, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "thigh_length_r"), 420, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "shank_length_l"), 400, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "foot_length_r"), std::hypot(250, 40), 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "upper_arm_length_l"), 300, 0.01);
  EXPECT_NEAR(Value(analysis.segment_lengths, "forearm_length_r"), 250, 0.01);
  for (const TimeSeries& length : analysis.segment_lengths) EXPECT_EQ(length.unit, "mm") << length.name;
  person.unit = LengthUnit::kBodyLengths;
  EXPECT_EQ(FindSeries(Analyse(person, true).segment_lengths, "pelvis_width")->unit, "body lengths");
}

TEST(Analyse, ComparesLeftWithRight) {
  PoseSequence person = Moving({{{"knee_angle_l", 50}, {"knee_angle_r", 20}, {"hip_flexion_r", 5}}, {}});
  // The left forearm becomes 10 % longer.
  const int elbow = person.skeleton().Find("LElbow").value();
  const int wrist = person.skeleton().Find("LWrist").value();
  person.PoseAt(0).row(wrist) += 0.1F * (person.PoseAt(0).row(wrist) - person.PoseAt(0).row(elbow));
  person.PoseAt(1).row(wrist).setConstant(std::nanf(""));
  const Analysis analysis = Analyse(person, false);
  EXPECT_NEAR(Value(analysis.symmetry, "forearm_length_symmetry"), 0.1 / 1.05, 1e-5);
  EXPECT_TRUE(std::isnan(Value(analysis.symmetry, "forearm_length_symmetry", 1)));
  EXPECT_NEAR(Value(analysis.symmetry, "thigh_length_symmetry"), 0, 1e-6);
  EXPECT_NEAR(Value(analysis.symmetry, "knee_angle_symmetry"), 30, 0.01);
  EXPECT_NEAR(Value(analysis.symmetry, "hip_flexion_symmetry"), -5, 0.01);
  EXPECT_EQ(FindSeries(analysis.symmetry, "forearm_length_symmetry")->unit, "");
  EXPECT_EQ(FindSeries(analysis.symmetry, "knee_angle_symmetry")->unit, "deg");
  EXPECT_EQ(FindSeries(analysis.symmetry, "pelvis_width_symmetry"), nullptr);
}

TEST(Analyse, EverySeriesHasAValueForEveryFrame) {
  const PoseSequence person = Moving(std::vector<testing::Posture>(7));
  const Analysis analysis = Analyse(person, true);
  for (const auto* group : {&analysis.angles, &analysis.segment_lengths, &analysis.symmetry}) {
    EXPECT_FALSE(group->empty());
    for (const TimeSeries& series : *group) EXPECT_EQ(series.values.size(), 7U) << series.name;
  }
}

TEST(Analyse, ContactsNeedUp) {
  // Someone stands on both feet for a second.
  const PoseSequence person = Moving(std::vector<testing::Posture>(50));
  const std::vector<FootContact> contacts = Analyse(person, true).contacts;
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_NE(contacts[0].is_left, contacts[1].is_left);
  EXPECT_EQ(contacts[0].first_frame, 0);
  EXPECT_EQ(contacts[0].last_frame, 49);
  EXPECT_TRUE(Analyse(person, false).contacts.empty());
}

TEST(Analyse, NobodyHasNothing) {
  const Analysis analysis = Analyse(PoseSequence(), true);
  EXPECT_TRUE(analysis.angles.empty() && analysis.segment_lengths.empty() && analysis.contacts.empty());
  const Analysis unseen = Analyse(PoseSequence(*FindSkeleton("h36m-17"), 3), true);
  ASSERT_FALSE(unseen.angles.empty());
  for (const TimeSeries& angle : unseen.angles) {
    for (const double value : angle.values) EXPECT_TRUE(std::isnan(value)) << angle.name;
  }
}

}  // namespace
}  // namespace canonpose
