#include "canonpose/data/duplicates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/ring_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PersonInRing;

std::string Refusal(const std::vector<Dataset>& datasets) {
  return ErrorOf(ErrorKind::kBadInput, [&] { RequireDistinctRecordings(datasets, {"a.h5", "b.h5"}); });
}

TEST(RequireDistinctRecordings, ACopyUnderAnotherNameIsRefused) {
  Dataset copy = PersonInRing();
  copy.sequences[0].name = "run";
  copy.sequences[0].capture = "elsewhere";
  copy.sequences[0].cameras[1].name = "another camera";
  EXPECT_THAT(Refusal({PersonInRing(), copy}),
              AllOf(HasSubstr("b.h5: run: "), HasSubstr("found the keypoints of walk in a.h5")));
}

TEST(RequireDistinctRecordings, APartOfARecordingIsRefused) {
  Dataset part = PersonInRing(4, 40);
  KeepFrames(part, {25, 39}, "b.h5");
  EXPECT_THAT(Refusal({PersonInRing(4, 40), part}), HasSubstr("given once"));
  part.sequences[0].cameras.resize(2);
  EXPECT_THAT(Refusal({part, PersonInRing(4, 40)}), HasSubstr("given once"));
}

TEST(RequireDistinctRecordings, HalvesOfARecordingAreTwo) {
  Dataset first = PersonInRing(4, 40);
  Dataset second = first;
  KeepFrames(first, {0, 21}, "a.h5");
  KeepFrames(second, {20, 39}, "b.h5");  // two frames of overlap are not worth a refusal
  RequireDistinctRecordings({first, second}, {"a.h5", "b.h5"});
}

TEST(RequireDistinctRecordings, FramesInWhichNothingWasSeenAreNotAlike) {
  Dataset blind = PersonInRing();
  for (CameraView& view : blind.sequences[0].cameras) {
    view.keypoints.assign(view.keypoints.size(), NAN);
    view.confidence.assign(view.confidence.size(), 0.0F);
  }
  RequireDistinctRecordings({blind, blind}, {"a.h5", "b.h5"});
}

}  // namespace
}  // namespace canonpose
