#include "canonpose/data/choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using canonpose::testing::ErrorOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Dataset TwoSequences() {
  Dataset dataset;
  for (const std::vector<std::string>& names : {std::vector<std::string>{"left", "right", "3"}, {"left", "back"}}) {
    Sequence sequence;
    sequence.name = "clip" + std::to_string(dataset.sequences.size());
    for (const std::string& name : names) {
      sequence.cameras.emplace_back();
      sequence.cameras.back().name = name;
    }
    dataset.sequences.push_back(sequence);
  }
  return dataset;
}

std::vector<std::string> NamesAfter(const std::string& choice, std::size_t sequence) {
  Dataset dataset = TwoSequences();
  KeepCameras(dataset, choice, "data.h5");
  std::vector<std::string> names;
  for (const CameraView& view : dataset.sequences.at(sequence).cameras) names.push_back(view.name);
  return names;
}

TEST(KeepCameras, TakesNamesOrANumber) {
  EXPECT_THAT(NamesAfter("2", 0), ElementsAre("left", "right"));
  EXPECT_THAT(NamesAfter("2", 1), ElementsAre("left", "back"));
  EXPECT_THAT(NamesAfter("back,left", 0), ElementsAre("left"));
  EXPECT_THAT(NamesAfter("back,left", 1), ElementsAre("left", "back"));
  // A camera of that name comes first; sequences without it go.
  EXPECT_THAT(NamesAfter("3", 0), ElementsAre("3"));
}

TEST(KeepCameras, RefusesUnknownCameras) {
  Dataset dataset = TwoSequences();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { KeepCameras(dataset, "front", "data.h5"); }),
              HasSubstr("back, left, right"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { KeepCameras(dataset, "4", "data.h5"); }), HasSubstr("4 cameras"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { KeepCameras(dataset, "left,", "data.h5"); }),
              HasSubstr("by name"));
}

TEST(KeepSubjects, TakesNames) {
  Dataset dataset = TwoSequences();
  dataset.sequences[0].subject = "S1";
  dataset.sequences[1].subject = "S5";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { KeepSubjects(dataset, "S1,S6", "data.h5"); }), HasSubstr("S1, S5"));
  KeepSubjects(dataset, "s5", "data.h5");
  ASSERT_EQ(dataset.sequences.size(), 1U);
  EXPECT_EQ(dataset.sequences[0].subject, "S5");
}

TEST(RequireTwoCameras, OneCameraIsBadInput) {
  Dataset dataset = TwoSequences();
  RequireTwoCameras(dataset, "data.h5");
  for (Sequence& sequence : dataset.sequences) sequence.cameras.resize(1);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { RequireTwoCameras(dataset, "data.h5"); }),
              ::testing::AllOf(HasSubstr("data.h5: expected at least two cameras"), HasSubstr("found one, left")));
}

}  // namespace
}  // namespace canonpose
