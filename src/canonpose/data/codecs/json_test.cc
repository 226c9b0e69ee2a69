#include "canonpose/data/codecs/json.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::string LoadError(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.json", text);
  return ErrorOf(ErrorKind::kBadInput, [&] { JsonValue::Load(folder / "a.json"); });
}

JsonValue Load(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.json", text);
  return JsonValue::Load(folder / "a.json");
}

TEST(Json, ValuesKnowTheirPlace) {
  const JsonValue root = Load(R"({"people": [{"a": [1, 2.5]}]})");
  const JsonValue numbers = root["people"].At(0)["a"];
  EXPECT_EQ(numbers.place(), "people[0].a");
  EXPECT_EQ(numbers.Numbers(), (std::vector<double>{1.0, 2.5}));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)numbers.String(); }),
              AllOf(HasSubstr("a.json: people[0].a: expected a string, found an array of 2 values")));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)root["bodies"]; }),
              HasSubstr("an object with bodies, found one with people"));
}

TEST(Json, CutOffFilesSayWhere) {
  for (const char* text :
       {R"({"people": [)", R"({"people": [{"a": [1, 2)", R"({"peop)", R"({"a": tr)", R"({"a": 1.)", "[-"}) {
    EXPECT_THAT(LoadError(text), AllOf(HasSubstr("line 1"), HasSubstr("found the end of the file"))) << text;
  }
  EXPECT_THAT(LoadError("{\n\"a\": [1,\n2, 3"), HasSubstr("line 3, column 5 (a[2])"));
}

TEST(Json, EmptyFilesSaySo) {
  EXPECT_THAT(LoadError(""), HasSubstr("found an empty file"));
  EXPECT_THAT(LoadError(" \n"), HasSubstr("found an empty file"));
}

TEST(Json, NaNIsReadAsNull) {
  const JsonValue root = Load(R"({"note": "NaN \" NaN", "k": [1, NaN, -nan, null, "NaN", nan], "s": NaN})");
  EXPECT_EQ(root["note"].String(), "NaN \" NaN");
  EXPECT_TRUE(root["s"].IsNull());
  EXPECT_TRUE(root.Contains("s"));
  EXPECT_FALSE(root.Has("s"));
  const std::vector<double> numbers = root["k"].NumbersOrNaN();
  ASSERT_EQ(numbers.size(), 6U);
  EXPECT_EQ(numbers[0], 1.0);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_TRUE(std::isnan(numbers[i])) << i;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)root["k"].Numbers(); }),
              AllOf(HasSubstr("k[1]: expected a number, found null or NaN")));
  EXPECT_THAT(LoadError("[NaN, NaN, @]"), HasSubstr("line 1, column 12"));
  EXPECT_THAT(LoadError("[NaN, NaN, 1"), HasSubstr("found the end of the file"));
  EXPECT_THAT(LoadError("[NaN, nano]"), HasSubstr("line 1, column 8"));
}

TEST(Json, NumbersThatAreNotFiniteAreNamed) {
  EXPECT_THAT(LoadError(R"({"people": [{"k": [1, 2, Infinity]}]})"),
              AllOf(HasSubstr("(people[0].k[2])"), HasSubstr("expected a finite number, found Infinity")));
  EXPECT_THAT(LoadError("[1, -Infinity]"), AllOf(HasSubstr("([1])"), HasSubstr("found -Infinity")));
  EXPECT_THAT(LoadError("[inf]"), HasSubstr("found inf"));
  EXPECT_THAT(LoadError("[0, 1e999]"), AllOf(HasSubstr("([1])"), HasSubstr("expected a finite number, found 1e999")));
  EXPECT_THAT(LoadError("[0, -1e999]"), HasSubstr("found -1e999"));
}

TEST(Json, StructureIsDescribed) {
  EXPECT_EQ(Load("{}").DescribeStructure(), "an empty object");
  EXPECT_EQ(Load(R"({"b": 1, "a": 2})").DescribeStructure(), "an object with a, b");
  EXPECT_EQ(Load(R"([{"bbox": 1, "id": 2}, {}])").DescribeStructure(), "an array of 2 objects with bbox, id");
  EXPECT_EQ(Load("[[1], [2]]").DescribeStructure(), "an array of 2 values");
  EXPECT_EQ(Load("3").DescribeStructure(), "3");
}

TEST(Json, NumbersMustBeNumbersThatFit) {
  for (const auto& [text, found] :
       {std::pair("[1, null]", "found null"), std::pair("[1, \"NaN\"]", "expected a finite number"),
        std::pair("[1, 1e200]", "found 1e+200"), std::pair("[1, [2]]", "found an array of 1 value"),
        std::pair("[1, true]", "found true")}) {
    const JsonValue root = Load(text);
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)root.Numbers(); }),
                AllOf(HasSubstr("[1]: "), HasSubstr(found)));
  }
  EXPECT_EQ(Load("[3.0]").At(0).Integer(), 3);
  const JsonValue half = Load("[3.5]");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)half.At(0).Integer(); }), HasSubstr("a whole number"));
  const JsonValue huge = Load("[18446744073709551615]");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)huge.At(0).Integer(); }), HasSubstr("a smaller whole number"));
}

TEST(Json, OtherFilesAreRefused) {
  EXPECT_THAT(LoadError("hello, world"),
              AllOf(HasSubstr("line 1, column 1"), HasSubstr("expected JSON, found 'hello'")));
  EXPECT_THAT(LoadError("\x89HDF\r\n"),
              HasSubstr("expected JSON, found an HDF5 file; HDF5 files of detectors are read as"));
  EXPECT_THAT(LoadError(std::string("\0\0\0\x20"
                                    "ftypisom",
                                    12)),
              AllOf(HasSubstr("expected JSON, found a video; run a 2D keypoint detector on it first")));
  EXPECT_THAT(LoadError("[1] [2]"), HasSubstr("expected JSON"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { JsonValue::Load("/nonexistent/a.json"); }),
              AllOf(HasSubstr("/nonexistent/a.json"), HasSubstr("No such file")));
}

TEST(Json, AByteOrderMarkIsSkipped) { EXPECT_EQ(Load("\xEF\xBB\xBF[1]").Numbers().size(), 1U); }

}  // namespace
}  // namespace canonpose
