#include "canonpose/motion/readers/acclaim.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/motion/motion_testing.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PositionsByName;
using testing::TemporaryFolder;
using testing::TestData;

void ExpectAt(const std::map<std::string, Vector3d>& positions, const std::string& joint, const Vector3d& expected) {
  ASSERT_EQ(positions.count(joint), 1U) << joint;
  EXPECT_LT((positions.at(joint) - expected).norm(), 1e-9) << joint << ": " << positions.at(joint).transpose();
}

/// Unlike WriteFileAtomically(), this does not wait for the disk; the tests write hundreds of files.
void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

std::string TinyAsf() { return ReadFile(TestData("mocap/tiny.asf")); }
std::string TinyAmc() { return ReadFile(TestData("mocap/tiny.amc")); }

ArticulatedMotion Read(const std::string& asf, const std::string& amc) {
  const TemporaryFolder folder;
  WriteText(folder / "s.asf", asf);
  WriteText(folder / "s_1.amc", amc);
  return ReadAcclaim(folder / "s_1.amc");
}

std::string AsfError(const std::string& from, const std::string& to) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(Replaced(TinyAsf(), from, to), TinyAmc()); });
}

std::string AmcError(const std::string& from, const std::string& to) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(TinyAsf(), Replaced(TinyAmc(), from, to)); });
}

TEST(Acclaim, PositionsAreThoseComputedByHand) {
  const ArticulatedMotion motion = ReadAcclaim(TestData("mocap/tiny.amc"));
  EXPECT_EQ(motion.name, "tiny");
  EXPECT_EQ(motion.subject, "tiny");
  EXPECT_EQ(motion.fps, 120.0);
  ASSERT_EQ(motion.frame_count(), 3);
  std::map<std::string, Vector3d> at = PositionsByName(motion, 0);
  ASSERT_EQ(at.size(), 6U);
  ExpectAt(at, "root", {100, -200, 1000});
  ExpectAt(at, "thigh", {100, -200, 1000});
  ExpectAt(at, "trunk", {100, -200, 1000});
  ExpectAt(at, "shank", {100, -200, 600});
  ExpectAt(at, "shank_end", {100, -200, 200});
  ExpectAt(at, "trunk_end", {100, -200, 1500});
  // The thigh's axis turns its x to y (up), so that the thigh spins about itself and moves the shank, which rz has bent
  // sideways, to the back.
  at = PositionsByName(motion, 1);
  ExpectAt(at, "shank", {100, -200, 600});
  ExpectAt(at, "shank_end", {100, 200, 600});
  // The body is rotated about x first and then about y, the shank about x first and then about z.
  at = PositionsByName(motion, 2);
  ExpectAt(at, "trunk_end", {500, 0, 1000});
  ExpectAt(at, "shank", {-400, 0, 1000});
  ExpectAt(at, "shank_end", {-400, 0, 1400});
}

TEST(Acclaim, RestPoseIsTheSkeletonTurnedToZUp) {
  const ArticulatedMotion motion = ReadAcclaim(TestData("mocap/tiny.amc"));
  const std::vector<Vector3d> rest = RestPose(motion);
  std::map<std::string, Vector3d> at;
  for (std::size_t j = 0; j < rest.size(); ++j) at[motion.joints[j].name] = rest[j];
  ExpectAt(at, "trunk_end", {0, 0, 500});
  ExpectAt(at, "shank_end", {0, 0, -800});
}

TEST(Acclaim, OrdersUnitsAndLineEndingsMayDiffer) {
  const std::map<std::string, Vector3d> expected = PositionsByName(ReadAcclaim(TestData("mocap/tiny.amc")), 2);
  // Radians in both files.
  std::string asf =
      Replaced(Replaced(TinyAsf(), "angle deg", "angle rad"), "axis 0 0 90", "axis 0 0 1.5707963267948966");
  std::string amc = Replaced(Replaced(TinyAmc(), ":DEGREES\n", ""), "0 10 0 90 90 0",
                             "0 10 0 1.5707963267948966 1.5707963267948966 0");
  amc = Replaced(amc, "shank 90 90", "shank 1.5707963267948966 1.5707963267948966");
  for (const auto& [joint, position] : PositionsByName(Read(asf, amc), 2)) ExpectAt(expected, joint, position);
  // The root's values in another order; other line endings, tabs and blanks.
  asf = Replaced(TinyAsf(), "order TX TY TZ RX RY RZ", "order RX RY RZ TZ TY TX");
  amc = Replaced(TinyAmc(), "root 0 10 0 90 90 0", "root\t90  90 0 0 10 +0.0e-015 \t# comment");
  for (std::string* text : {&asf, &amc}) {
    std::string windows;
    for (const char c : *text) windows += c == '\n' ? std::string(" \r\n") : std::string(1, c);
    *text = windows;
  }
  for (const auto& [joint, position] : PositionsByName(Read(asf, amc), 2)) ExpectAt(expected, joint, position);
  // About y first and then about x is another pose: (0, 1, 0) to (0, 0, 1) in the file's axes.
  ExpectAt(PositionsByName(Read(Replaced(TinyAsf(), "axis XYZ", "axis YXZ"), TinyAmc()), 2), "trunk_end",
           {0, -500, 1000});
}

TEST(Acclaim, DamagedSkeletonsSayWhereAndWhat) {
  for (const char* section : {":units", ":root", ":bonedata", ":hierarchy"}) {
    EXPECT_THAT(AsfError(section, ":other"), AllOf(HasSubstr("s.asf"), HasSubstr(section))) << section;
  }
  EXPECT_THAT(AsfError("length 0.254", "length 0"), AllOf(HasSubstr("line 6"), HasSubstr("above 0")));
  EXPECT_THAT(AsfError("angle deg", "angle gon"), AllOf(HasSubstr("line 7"), HasSubstr("'angle gon'")));
  EXPECT_THAT(AsfError("length 4", "length four"), AllOf(HasSubstr("line 20"), HasSubstr("found 'four'")));
  EXPECT_THAT(AsfError("length 4", "length -4"), AllOf(HasSubstr("line 20"), HasSubstr("0 or more")));
  EXPECT_THAT(AsfError("length 4", "length nan"), AllOf(HasSubstr("line 20"), HasSubstr("finite")));
  EXPECT_THAT(AsfError("length 4", ""), HasSubstr("the length of thigh"));
  EXPECT_THAT(AsfError("direction 0 -1 0", "direction 0 0 0"), HasSubstr("the direction of thigh"));
  EXPECT_THAT(AsfError("direction 0 -1 0", "direction 0 -1"),
              AllOf(HasSubstr("3 values"), HasSubstr("found 2 values")));
  EXPECT_THAT(AsfError("axis 0 0 90 XYZ", "axis 0 0 90 XXZ"), HasSubstr("found 'XXZ'"));
  EXPECT_THAT(AsfError("dof rz rx", "dof rz rz"), HasSubstr("once"));
  EXPECT_THAT(AsfError("dof rz rx", "dof rz rw"), HasSubstr("found 'rw'"));
  EXPECT_THAT(AsfError("dof rz rx", "dof rz tx"), HasSubstr("rotations"));
  EXPECT_THAT(AsfError("name trunk", "name thigh"), HasSubstr("'thigh' again"));
  EXPECT_THAT(AsfError("root thigh trunk", "root thigh trunk tail"), AllOf(HasSubstr("line 44"), HasSubstr("'tail'")));
  EXPECT_THAT(AsfError("root thigh trunk", "root thigh"), HasSubstr("a path from the root to trunk"));
  EXPECT_THAT(AsfError("root thigh trunk", "root thigh trunk shank"), HasSubstr("found root and thigh"));
  EXPECT_THAT(AsfError("thigh shank\n", "thigh root\n"), HasSubstr("cycle"));
  EXPECT_THAT(AsfError("root thigh trunk\n    thigh shank", "root trunk\n thigh shank\n shank thigh"),
              HasSubstr("cycle"));
  EXPECT_THAT(AsfError("  end\n:hierarchy", ":hierarchy"), HasSubstr("the end of bone trunk"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Read("", TinyAmc()); }), HasSubstr("an empty file"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { Read("{\"a\": 1}", TinyAmc()); }),
              HasSubstr("not an Acclaim skeleton"));
}

TEST(Acclaim, EveryTruncationOfASkeletonIsDetected) {
  const std::string whole = TinyAsf();
  const std::size_t last = whole.rfind("end");
  for (std::size_t size = 0; size < last; size += 7) {
    const std::string message = ErrorOf(ErrorKind::kBadInput, [&] { Read(whole.substr(0, size), TinyAmc()); });
    EXPECT_THAT(message, HasSubstr("s.asf")) << size;
  }
}

TEST(Acclaim, DamagedMotionsSayWhereAndWhat) {
  EXPECT_THAT(AmcError("thigh 90", "calf 90"),
              AllOf(HasSubstr("line 10"), HasSubstr("another skeleton"), HasSubstr("'calf'")));
  EXPECT_THAT(AmcError("shank 90 0", "shank 90"),
              AllOf(HasSubstr("line 11"), HasSubstr("expected 2 values of shank in frame 2, found 1 value")));
  EXPECT_THAT(AmcError("shank 90 0", "shank 90 0 1"), HasSubstr("found 3 values"));
  EXPECT_THAT(AmcError("shank 90 0", "shank 90 O"),
              AllOf(HasSubstr("line 11"), HasSubstr("expected a number, found 'O'")));
  EXPECT_THAT(AmcError("shank 90 0", "shank 90 0,5"), HasSubstr("found '0,5'"));
  for (const char* word : {"nan", "-inf", "1e999"}) {
    EXPECT_THAT(AmcError("shank 90 0", fmt::format("shank 90 {}", word)), AllOf(HasSubstr("finite"), HasSubstr(word)));
  }
  EXPECT_THAT(AmcError("shank 90 0", "shank 90 1e20"), HasSubstr("1e20"));
  EXPECT_THAT(AmcError("thigh 90\n", ""), AllOf(HasSubstr("line 11"), HasSubstr("bone thigh in frame 2")));
  EXPECT_THAT(AmcError("thigh 90\n", "thigh 90\nthigh 90\n"), AllOf(HasSubstr("line 11"), HasSubstr("thigh again")));
  EXPECT_THAT(AmcError("\n3\n", "\n4\n"), AllOf(HasSubstr("line 12"), HasSubstr("expected frame 3, found frame 4")));
  EXPECT_THAT(AmcError("\n2\n", "\n99999999999999999999\n"), HasSubstr("the number of a frame"));
  EXPECT_THAT(AmcError("\n1\n", "\n"), AllOf(HasSubstr("line 4"), HasSubstr("the number of a frame")));
  EXPECT_THAT(AmcError("\n2\n", "\n:DEGREES\n2\n"), HasSubstr("line 8"));
  EXPECT_THAT(AmcError("shank 90 90\n", ""),
              AllOf(HasSubstr("bone shank in frame 3, found the end of the file"), HasSubstr("cut off")));
  // A bone without degrees of freedom must not appear in a frame.
  EXPECT_THAT(AmcError("thigh 90", "trunk 90"), HasSubstr("expected 0 values of trunk"));
  for (const char* empty : {"", "# nothing\n", ":DEGREES\n"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Read(TinyAsf(), empty); }), HasSubstr("not an Acclaim motion"));
  }
}

TEST(Acclaim, FindsTheSkeletonOfAClip) {
  const TemporaryFolder folder;
  WriteText(folder / "7_1.amc", TinyAmc());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAcclaim(folder / "7_1.amc"); }),
              AllOf(HasSubstr("7_1.amc"), HasSubstr(".asf"), HasSubstr("found none")));
  WriteText(folder / "someone.asf", TinyAsf());
  EXPECT_EQ(ReadAcclaim(folder / "7_1.amc").subject, "someone");
  WriteText(folder / "other.asf", TinyAsf());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAcclaim(folder / "7_1.amc"); }), HasSubstr("2 of other names"));
  WriteText(folder / "7.ASF", TinyAsf());
  EXPECT_EQ(ReadAcclaim(folder / "7_1.amc").subject, "7");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAcclaim(folder / "8_1.amc"); }), HasSubstr("check the path"));
}

}  // namespace
}  // namespace canonpose
