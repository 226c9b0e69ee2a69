#include "canonpose/evaluate/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ProtocolTest, TheDefaultTakesEverything) {
  const Protocol& all = FindProtocol(kAllFrames);
  EXPECT_EQ(all.name, Protocols().front().name);
  EXPECT_TRUE(HasSubject(all, "whoever"));
  EXPECT_EQ(all.frame_step, 1);
  EXPECT_EQ(all.weighting, Weighting::kPoses);
  EXPECT_TRUE(all.pck.joints.empty());
}

TEST(ProtocolTest, SubjectsAndNamesAreFoundInAnyCase) {
  const Protocol& human = FindProtocol("H36M-1");
  EXPECT_EQ(human.name, "h36m-1");
  EXPECT_TRUE(HasSubject(human, "s11"));
  EXPECT_FALSE(HasSubject(human, "S1"));
}

TEST(ProtocolTest, AnUnknownNameListsTheProtocols) {
  try {
    FindProtocol("h36m");
    FAIL() << "no Error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidArgument);
    EXPECT_STREQ(error.what(),
                 "there is no `protocol` h36m; the protocols are all-frames, h36m-1, h36m-2, 3dhp, skipose");
  }
}

TEST(ProtocolTest, EveryValueIsDescribedInWords) {
  const std::string list = ProtocolList();
  EXPECT_THAT(list,
              AllOf(HasSubstr("h36m-2: "), HasSubstr("frames 0, 64, 128, ... of every sequence and view of S9 and"),
                    HasSubstr("means over actions"), HasSubstr("univ_annot3"), HasSubstr("head_top, neck")));
  EXPECT_EQ(HeadlineKey(FindProtocol("h36m-1")), "n_mpjpe_mm");
  EXPECT_EQ(HeadlineKey(FindProtocol("h36m-2")), "p_mpjpe_mm");
  EXPECT_EQ(HeadlineKey(FindProtocol("3dhp")), "pck150_percent");
  EXPECT_EQ(HeadlineName(FindProtocol("3dhp")), "PCK150");
}

TEST(ProtocolTest, TakesOfAnActionAreMergedIfTheProtocolSaysSo) {
  const Protocol& human = FindProtocol("h36m-1");
  EXPECT_EQ(ActionOf(human, "Walking 1"), "Walking");
  EXPECT_EQ(ActionOf(human, "Walking"), "Walking");
  EXPECT_EQ(ActionOf(human, "On The Floor"), "On The Floor");
  EXPECT_EQ(ActionOf(human, ""), "");
  EXPECT_EQ(ActionOf(human, "Walking "), "Walking ");
  EXPECT_EQ(ActionOf(FindProtocol(kAllFrames), "Walking 1"), "Walking 1");
}

}  // namespace
}  // namespace canonpose
