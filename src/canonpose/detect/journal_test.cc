#include "canonpose/detect/journal.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

FrameAnswers Answers(float value) {
  return {{NetworkAnswer::Kind::kPose, std::vector<float>(52, value)},
          {NetworkAnswer::Kind::kPeople, {}},
          {NetworkAnswer::Kind::kAppearance, {value, 1.0F / 3.0F, 0, 0, 0, std::numeric_limits<float>::quiet_NaN()}}};
}

TEST(Journal, KeepsAnswersToTheBit) {
  const testing::TemporaryFolder folder;
  {
    Journal journal(folder / "j", "subject");
    EXPECT_THAT(journal.known(), SizeIs(0));
    journal.Append(Answers(0.1F));
    journal.Append(Answers(1e-20F));
  }
  Journal again(folder / "j", "subject");
  ASSERT_THAT(again.known(), SizeIs(2));
  const FrameAnswers& first = again.known().front();
  ASSERT_THAT(first, SizeIs(3));
  EXPECT_EQ(first[0].numbers, std::vector<float>(52, 0.1F));
  EXPECT_THAT(first[1].numbers, SizeIs(0));
  EXPECT_EQ(first[2].numbers[1], 1.0F / 3.0F);
  EXPECT_TRUE(std::isnan(first[2].numbers[5]));
}

TEST(Journal, DropsALineThatWasNotFinishedAndGoesOnThere) {
  const testing::TemporaryFolder folder;
  {
    Journal journal(folder / "j", "subject");
    for (const float value : {1.0F, 2.0F, 3.0F}) journal.Append(Answers(value));
  }
  std::filesystem::resize_file(folder / "j", std::filesystem::file_size(folder / "j") - 5);
  {
    Journal journal(folder / "j", "subject");
    EXPECT_THAT(journal.known(), SizeIs(2));
    journal.Append(Answers(4.0F));
  }
  Journal journal(folder / "j", "subject");
  ASSERT_THAT(journal.known(), SizeIs(3));
  EXPECT_EQ(journal.known().back()[0].numbers.front(), 4.0F);
}

TEST(Journal, StopsAtDamage) {
  const testing::TemporaryFolder folder;
  {
    Journal journal(folder / "j", "subject");
    for (const float value : {1.0F, 2.0F, 3.0F}) journal.Append(Answers(value));
  }
  std::string text = ReadFile(folder / "j");
  text.replace(text.find("2.0"), 3, "two");
  WriteFileAtomically(folder / "j", text);
  EXPECT_THAT(Journal(folder / "j", "subject").known(), SizeIs(1));
}

TEST(Journal, KeepsAnswersAboutAnotherSubject) {
  const testing::TemporaryFolder folder;
  Journal(folder / "j", "subject").Append(Answers(1.0F));
  const std::string before = ReadFile(folder / "j");
  EXPECT_THAT(
      testing::ErrorOf(ErrorKind::kBadInput, [&] { const Journal journal(folder / "j", "another"); }),
      AllOf(HasSubstr("expected another"), HasSubstr("found subject"), HasSubstr("remove " + (folder / "j").string())));
  EXPECT_EQ(ReadFile(folder / "j"), before);
  EXPECT_THAT(Journal(folder / "j", "subject").known(), SizeIs(1));
}

TEST(Journal, BeginsAnewWhereThereIsNoAnswerYet) {
  const testing::TemporaryFolder folder;
  for (const char* text : {"", "sub", "another\n"}) {
    WriteFileAtomically(folder / "j", text);
    Journal(folder / "j", "subject").Append(Answers(1.0F));
    EXPECT_THAT(Journal(folder / "j", "subject").known(), SizeIs(1)) << text;
  }
}

TEST(RecordedNetwork, AnswersFromTheRecordAsFarAsItGoes) {
  testing::Walker walker;
  walker.x = [](long) { return 300.0F; };
  testing::WalkerNetwork real({walker});
  RecordedNetwork network(real);
  const DetectedPose pose = real.PoseOf(0);
  const Crop crop = CropAround(pose, 640, 480);
  network.Begin({});
  (void)network.FindPeople({});
  (void)network.PoseInCrop({}, crop);
  const FrameAnswers answers = network.answers();
  EXPECT_EQ(real.searches, 1);
  EXPECT_EQ(real.crops, 1);

  network.Begin(answers);
  const std::vector<DetectedPose> people = network.FindPeople({});
  ASSERT_THAT(people, SizeIs(1));
  EXPECT_EQ(people[0].joints[kNose].position, pose.joints[kNose].position);
  EXPECT_EQ(network.PoseInCrop({}, crop).score, pose.score);
  EXPECT_EQ(real.searches, 1) << "the record answered";
  EXPECT_EQ(real.crops, 1);
  (void)network.PoseInCrop({}, crop);  // a further question
  EXPECT_EQ(real.crops, 2);

  network.Begin(answers);
  (void)network.PoseInCrop({}, crop);  // not what the record has next
  (void)network.FindPeople({});
  EXPECT_EQ(real.crops, 3);
  EXPECT_EQ(real.searches, 2);
}

}  // namespace
}  // namespace canonpose
