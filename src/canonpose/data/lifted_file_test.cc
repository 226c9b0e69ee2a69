// Files of `lift` that cannot be read. export/lift_output_test.cc reads those that it writes.
#include "canonpose/data/lifted_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/read_scenes.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::string WithReplaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

const std::string kText =
    R"({"units": "mm", "fps": 25.0, "joints": ["Hip", "LKnee", "RKnee"], "parents": [-1, 0, 0], "frames": [4, 6],)"
    R"( "pose3d": [[[0, 0, 0], [1, 2, 3], [4, 5, 6]], [[0, 0, 0], [null, null, null], [7, 8, 9]]],)"
    R"( "confidence": [[1, 1, 0.5], [1, 0, 1]], "standard_deviation": [[null, 1, 2], [null, null, 3]]})";

Scene Read(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "poses.json", text);
  return ReadScenes(folder / "poses.json").at(0);
}

std::string ErrorAfter(const std::string& from, const std::string& to) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(WithReplaced(kText, from, to)); });
}

TEST(LiftedFile, BecomesAScene) {
  const Scene scene = Read(kText);
  EXPECT_EQ(scene.name, "poses");
  EXPECT_TRUE(scene.up.is_known() && scene.scale.is_known());
  const PoseSequence& person = scene.people.at(0);
  EXPECT_EQ(person.unit, LengthUnit::kMillimetres);
  EXPECT_EQ(person.coordinate_frame.kind, CoordinateFrame::Kind::kWorld);
  // Right, down, away from the camera becomes right, away, up.
  EXPECT_EQ(person.PoseAt(0).row(1), Eigen::RowVector3f(1, 3, -2));
  EXPECT_FALSE(person.IsKnown(1, 1));
  EXPECT_EQ(person.confidence()[2], 0.5F);
  EXPECT_EQ(person.standard_deviation()[1], 1.0F);
  EXPECT_THAT(person.time_seconds, ::testing::ElementsAre(4 / 25.0, 6 / 25.0));  // frame 5 is missing
  EXPECT_EQ(person.skeleton().mirror, (std::vector<int>{0, 2, 1}));
  EXPECT_NO_THROW(scene.Validate());
}

TEST(LiftedFile, NetworkUnitsHaveNoScale) {
  const Scene scene = Read(WithReplaced(kText, "\"mm\"", "\"network units\""));
  EXPECT_FALSE(scene.scale.is_known());
  EXPECT_EQ(scene.people.at(0).unit, LengthUnit::kEachItsOwn);
}

TEST(LiftedFile, DamageIsOneLine) {
  EXPECT_THAT(ErrorAfter("\"mm\"", "\"feet\""),
              HasSubstr("units: expected \"mm\" or \"network units\", found \"feet\""));
  EXPECT_THAT(ErrorAfter("[-1, 0, 0]", "[0, 0, 0]"), HasSubstr("parents: expected a root"));
  EXPECT_THAT(ErrorAfter("[-1, 0, 0]", "[-1, 0, 9]"), HasSubstr("joints: expected a skeleton"));
  EXPECT_THAT(ErrorAfter("[4, 6]", "[6, 4]"), HasSubstr("frames: expected ascending numbers"));
  EXPECT_THAT(ErrorAfter("[4, 6]", "[4]"), HasSubstr("pose3d: expected 9 values, found 18"));
  EXPECT_THAT(ErrorAfter("[1, 1, 0.5]", "[1, 1, 5]"), HasSubstr("confidence: expected numbers from 0 to 1"));
  EXPECT_THAT(ErrorAfter("pose3d", "pose4d"), HasSubstr("expected poses that `canonpose lift` wrote"));
}

TEST(LiftedFile, OtherArchivesAreRefused) {
  const TemporaryFolder folder;
  NpzWriter writer(folder / "other.npz");
  writer.Add("x", std::vector<float>{1.0F}, {1});
  writer.Commit();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadScenes(folder / "other.npz"); }),
              HasSubstr("expected poses that `canonpose lift` wrote, found other arrays"));
}

}  // namespace
}  // namespace canonpose
