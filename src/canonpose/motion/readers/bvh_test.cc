#include "canonpose/motion/readers/bvh.h"

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

std::string Tiny() { return ReadFile(TestData("mocap/tiny.bvh")); }

/// Unlike WriteFileAtomically(), this does not wait for the disk; the tests write hundreds of files.
void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

ArticulatedMotion Read(const std::string& text, double unit_mm = 10.0) {
  const TemporaryFolder folder;
  WriteText(folder / "clip.bvh", text);
  return ReadBvh(folder / "clip.bvh", unit_mm);
}

std::string BvhError(const std::string& from, const std::string& to) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(Replaced(Tiny(), from, to)); });
}

void ExpectHandComputed(const ArticulatedMotion& motion) {
  ASSERT_EQ(motion.frame_count(), 2);
  ASSERT_EQ(motion.joint_count(), 5);
  const auto expect_at = [&](int frame, const char* joint, const Vector3d& expected) {
    const Vector3d found = PositionsByName(motion, frame).at(joint);
    EXPECT_LT((found - expected).norm(), 1e-9) << joint << " in " << frame << ": " << found.transpose();
  };
  expect_at(0, "Hips", {0, 0, 1000});
  expect_at(0, "Spine_end", {0, 0, 1900});
  expect_at(0, "The Limb", {100, 0, 1000});
  expect_at(0, "The Limb_end", {100, 0, 200});
  // The root rotates by Rx * Ry, the spine by Ry * Rz: the last rotation in the file is applied first.
  expect_at(1, "Spine", {0, -500, 1000});
  expect_at(1, "Spine_end", {400, -500, 1000});
  expect_at(1, "The Limb", {0, 0, 1100});
}

TEST(Bvh, PositionsAreThoseComputedByHand) {
  const ArticulatedMotion motion = ReadBvh(TestData("mocap/tiny.bvh"), 10.0);
  EXPECT_EQ(motion.name, "tiny");
  EXPECT_EQ(motion.subject, "mocap");
  EXPECT_EQ(motion.fps, 120.0);
  ExpectHandComputed(motion);
}

TEST(Bvh, LayoutOfTheTextDoesNotMatter) {
  std::string text = Tiny();
  text = Replaced(text, "JOINT Spine\n\t{\n\t\tOFFSET", "JOINT   Spine {\n\t\tOFFSET");
  text = Replaced(text, "Frames: 2", "frames:2");
  text = Replaced(text, "Frame Time: ", "Frame\tTime:  ");
  text = Replaced(text, "Yrotation Xrotation Zrotation", "YROTATION xrotation Zrotation");
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string(" \t\r\n\r\n") : std::string(1, c);
  ExpectHandComputed(Read(windows));
}

TEST(Bvh, PositionsOfJointsOtherThanTheRootMustBeTheirOffset) {
  // The file's 10.00001 is an exporter's rounding, but half a centimetre is not.
  EXPECT_THAT(BvhError("10.00001", "10.5"),
              AllOf(HasSubstr("frame 2"), HasSubstr("The Limb at its OFFSET, 10 along x"), HasSubstr("10.5")));
}

/// The tiny body below other joints, whose channels have the values `above` in every frame.
std::string Below(const std::string& channels, const std::string& above, const std::string& offset = "0 0 0") {
  std::string text = Replaced(Tiny(), "ROOT Hips", "JOINT Hips");
  text =
      Replaced(text, "HIERARCHY\n", "HIERARCHY\nROOT Armature\n{\nOFFSET " + offset + "\nCHANNELS " + channels + "\n");
  text = Replaced(text, "\nMOTION", "\n}\nMOTION");
  const std::size_t rows = text.find('\n', text.find("Frame Time")) + 1;
  std::string result = text.substr(0, rows);
  for (std::size_t i = rows; i < text.size();) {
    const std::size_t end = text.find('\n', i);
    if (end > i) result += above + " " + text.substr(i, end - i) + "\n";
    i = end == std::string::npos ? text.size() : end + 1;
  }
  return result;
}

TEST(Bvh, AStillRootAboveTheMotionIsNotTheRoot) {
  ExpectHandComputed(Read(Below("0", "")));
  ExpectHandComputed(Read(Below("6 Xposition Yposition Zposition Zrotation Xrotation Yrotation", "0 0 0 0 0 0")));
  // What it does becomes part of the motion: here it moves by (1, 2, 3) and turns by 90 degrees about y, which is up.
  const ArticulatedMotion moved = Read(Below("4 Xposition Yposition Zposition Yrotation", "1 2 3 90"));
  const ArticulatedMotion plain = Read(Tiny());
  EXPECT_EQ(moved.joints.front().name, "Hips");
  for (int t = 0; t < 2; ++t) {
    const std::map<std::string, Vector3d> expected = PositionsByName(plain, t);
    for (const auto& [name, at] : PositionsByName(moved, t)) {
      const Vector3d& before = expected.at(name);
      EXPECT_LT((at - Vector3d(-before.y() + 10, before.x() - 30, before.z() + 20)).norm(), 1e-6) << name;
    }
  }
}

TEST(Bvh, TheUnitFollowsFromTheStature) {
  struct Case {
    double scale;
    double unit_mm;
  };
  // The tiny body is 170 units tall.
  for (const Case& c :
       {Case{0.01, 1000.0}, {0.1, 100.0}, {1.0, 10.0}, {10.0, 1.0}, {1.0 / 2.54, 25.4}, {0.45 / 2.54, 25.4 / 0.45}}) {
    std::string text = Tiny();
    text = Replaced(text, "OFFSET 0 50 0", fmt::format("OFFSET 0 {:.9f} 0", 50 * c.scale));
    text = Replaced(text, "OFFSET 0 40 0", fmt::format("OFFSET 0 {:.9f} 0", 40 * c.scale));
    text = Replaced(text, "OFFSET 0 -80 0", fmt::format("OFFSET 0 {:.9f} 0", -80 * c.scale));
    text = Replaced(text, "OFFSET 10 0 0", fmt::format("OFFSET {:.9f} 0 0", 10 * c.scale));
    text = Replaced(text, "0 0 0 10 0 0", fmt::format("0 0 0 {:.9f} 0 0", 10 * c.scale));
    text = Replaced(text, "10.00001 0 0", fmt::format("{:.9f} 0 0", 10 * c.scale));
    const std::map<std::string, Vector3d> at = PositionsByName(Read(text, 0.0), 0);
    EXPECT_NEAR(at.at("Spine").z() - at.at("Hips").z(), 500.0, 1e-3) << c.unit_mm;
  }
  const TemporaryFolder folder;
  WriteText(folder / "clip.bvh", Replaced(Tiny(), "OFFSET 0 50 0", "OFFSET 0 300 0"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadBvh(folder / "clip.bvh"); }),
              AllOf(HasSubstr("clip.bvh"), HasSubstr("420 units tall")));
}

TEST(Bvh, DamagedHierarchiesSayWhereAndWhat) {
  EXPECT_THAT(BvhError("HIERARCHY", "hello"), AllOf(HasSubstr("line 1"), HasSubstr("not a BVH file")));
  EXPECT_THAT(BvhError("ROOT Hips", "ROOT"), AllOf(HasSubstr("line 2"), HasSubstr("a name")));
  EXPECT_THAT(BvhError("JOINT The Limb", "JOINT Spine"), AllOf(HasSubstr("line 15"), HasSubstr("'Spine' again")));
  EXPECT_THAT(BvhError("OFFSET 0 50 0", "OFFSET 0 50"), AllOf(HasSubstr("line 8"), HasSubstr("found 2 values")));
  EXPECT_THAT(BvhError("OFFSET 0 50 0", "OFFSET 0 5O 0"), AllOf(HasSubstr("line 8"), HasSubstr("found '5O'")));
  EXPECT_THAT(BvhError("OFFSET 0 50 0", ""), HasSubstr("the OFFSET of Spine"));
  EXPECT_THAT(BvhError("\t\tCHANNELS 3 Yrotation Xrotation Zrotation\n", ""), HasSubstr("the CHANNELS of Spine"));
  EXPECT_THAT(BvhError("CHANNELS 3", "CHANNELS 4"),
              AllOf(HasSubstr("line 9"), HasSubstr("expected 4 channels of Spine, found 3 names")));
  for (const char* count : {"-3", "7", "x", "99999999999"}) {
    EXPECT_THAT(BvhError("CHANNELS 3", fmt::format("CHANNELS {}", count)), HasSubstr("from 0 to 6")) << count;
  }
  EXPECT_THAT(BvhError("3 Yrotation", "3 Wrotation"), AllOf(HasSubstr("line 9"), HasSubstr("found 'Wrotation'")));
  EXPECT_THAT(BvhError("3 Yrotation", "3 Yscale"), HasSubstr("found 'Yscale'"));
  EXPECT_THAT(BvhError("3 Yrotation", "3 Xrotation"), HasSubstr("once"));
  EXPECT_THAT(BvhError("\n}\nMOTION", "\nMOTION"), AllOf(HasSubstr("MOTION"), HasSubstr("brace")));
  EXPECT_THAT(BvhError("\n}\nMOTION", "\n}\n}\nMOTION"), HasSubstr("braces do not balance"));
  EXPECT_THAT(BvhError("JOINT Spine\n\t{", "JOINT Spine\n\t"), HasSubstr("the opening brace of Spine"));
  EXPECT_THAT(BvhError("MOTION\n", "}\nMOTION\n"), HasSubstr("braces do not balance"));
}

TEST(Bvh, ChannelsMayBeFewAndEndSitesEmpty) {
  // A root that only rotates and rises, a joint that cannot move, a leaf of zero length.
  const ArticulatedMotion motion = Read(
      "HIERARCHY\nROOT a\n{\nOFFSET 1 2 3\nCHANNELS 2 Yposition Zrotation\nJOINT b\n{\nOFFSET 0 80 0\nCHANNELS 0\n"
      "JOINT c\n{\nOFFSET 0 90 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 0 0\n}\n}\n}\n}\n"
      "MOTION\nFrames: 1\nFrame Time: 0.04\n100 90 5\n");
  ASSERT_EQ(motion.joint_count(), 3);
  EXPECT_EQ(motion.fps, 25.0);
  const std::map<std::string, Vector3d> at = PositionsByName(motion, 0);
  EXPECT_LT((at.at("a") - Vector3d(10, -30, 1000)).norm(), 1e-9);
  EXPECT_LT((at.at("c") - Vector3d(-1690, -30, 1000)).norm(), 1e-9);
}

TEST(Bvh, DamagedMotionsSayWhereAndWhat) {
  const std::string tiny = Tiny();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Read(tiny.substr(0, tiny.find("MOTION"))); }),
              AllOf(HasSubstr("expected MOTION, found the end of the file")));
  EXPECT_THAT(BvhError("Frames: 2", "Frames: 3"), AllOf(HasSubstr("3 rows, the number after Frames:, found 2 rows")));
  EXPECT_THAT(BvhError("Frames: 2", "Frames: 1"), AllOf(HasSubstr("line 29"), HasSubstr("more rows")));
  // Such a count must not be trusted before the rows are read.
  EXPECT_THAT(BvhError("Frames: 2", "Frames: 900000000"), HasSubstr("found 2 rows"));
  for (const char* count : {"-2", "0", "2.5", "two", ""}) {
    EXPECT_THAT(BvhError("Frames: 2", fmt::format("Frames: {}", count)), HasSubstr("line 26")) << count;
  }
  for (const char* seconds : {"0", "-0.1", "1e-310", "nan", "fast"}) {
    EXPECT_THAT(BvhError("0.0083333", seconds), HasSubstr("line 27")) << seconds;
  }
  EXPECT_THAT(
      BvhError("0 100 0 0 90", "0 100 0 90"),
      AllOf(HasSubstr("line 29"), HasSubstr("expected 15 values of frame 2, one for each channel, found 14 values")));
  EXPECT_THAT(BvhError("0 100 0 0 90", "0 100 0 0 nan"), AllOf(HasSubstr("line 29"), HasSubstr("finite")));
  EXPECT_THAT(BvhError("0 100 0 0 90", "0 100 0 0 9-0"), AllOf(HasSubstr("line 29"), HasSubstr("found '9-0'")));
}

TEST(Bvh, EveryTruncationIsDetected) {
  const std::string whole = Tiny();
  // Except in the last value, which may lack a digit and still be a number.
  for (std::size_t size = 0; size + 4 < whole.size(); size += 3) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Read(whole.substr(0, size)); }), HasSubstr("clip.bvh")) << size;
  }
}

}  // namespace
}  // namespace canonpose
