#include "canonpose/data/merge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/ring_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;

Dataset Recording(const std::string& name, const std::string& capture) {
  Dataset dataset = testing::PersonInRing(2);
  dataset.sequences.resize(1);
  dataset.sequences.front().name = name;
  dataset.sequences.front().capture = capture.empty() ? "default" : capture;
  dataset.sequences.front().capture_is_named = !capture.empty();
  return dataset;
}

std::vector<std::string> NamesOf(const Dataset& dataset, std::string Sequence::*member) {
  std::vector<std::string> names;
  for (const Sequence& sequence : dataset.sequences) names.push_back(sequence.*member);
  return names;
}

TEST(MergeDatasets, CapturesOfOneNameAreOne) {
  const Dataset merged =
      MergeDatasets({Recording("walk", "studio"), Recording("run", "studio"), Recording("run", "yard")},
                    {"morning.h5", "noon.h5", "day/night.h5"});
  EXPECT_THAT(NamesOf(merged, &Sequence::name), ElementsAre("walk", "run", "night-run"));
  EXPECT_THAT(NamesOf(merged, &Sequence::capture), ElementsAre("studio", "studio", "yard"));
}

TEST(MergeDatasets, CapturesWithoutANameAreTheirFiles) {
  const Dataset merged =
      MergeDatasets({Recording("a", ""), Recording("a", ""), Recording("a", ""), Recording("b", "default")},
                    {"x.h5", "1/y.h5", "2/y.h5", "z.h5"});
  EXPECT_THAT(NamesOf(merged, &Sequence::name), ElementsAre("a", "y-a", "y-a-2", "b"));
  EXPECT_THAT(NamesOf(merged, &Sequence::capture), ElementsAre("x-default", "y-default", "y-default-2", "default"));
  for (const Sequence& sequence : merged.sequences) EXPECT_TRUE(sequence.capture_is_named);
}

TEST(MergeDatasets, ASingleDatasetStaysAsItIs) {
  const Dataset merged = MergeDatasets({Recording("a", "")}, {"x.h5"});
  EXPECT_EQ(merged.sequences.front().capture, "default");
  EXPECT_FALSE(merged.sequences.front().capture_is_named);
}

TEST(MergeDatasets, OtherJointsAreRefusedAndOtherSourcesReported) {
  Dataset other = Recording("b", "");
  other.source.format = "openpose";
  const CollectedMessages messages;
  MergeDatasets({Recording("a", ""), other}, {"x.h5", "y.h5"});
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("x.h5"), HasSubstr("y.h5 are openpose")));
  other.skeleton.joints.back() = "Tail";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        MergeDatasets({Recording("a", ""), other}, {"x.h5", "y.h5"});
                      }),
              AllOf(HasSubstr("y.h5: /skeleton: expected the joints of x.h5"), HasSubstr("Tail")));
}

}  // namespace
}  // namespace canonpose
