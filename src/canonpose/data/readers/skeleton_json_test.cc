#include "canonpose/data/readers/skeleton_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

Skeleton Read(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "mouse.json", text);
  return ReadSkeletonJson(folder / "mouse.json");
}

std::string ReadError(const std::string& text) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(text); });
}

TEST(SkeletonJson, AsInTheDataset) {
  const Skeleton mouse =
      Read(R"({"joints":["nose","l ear","r ear","tail"],"parents":[3,0,0,-1],"root":3,"mirror":[0,2,1,3]})");
  EXPECT_EQ(mouse.name, "mouse");
  EXPECT_THAT(mouse.joints, ElementsAre("nose", "l ear", "r ear", "tail"));
  EXPECT_THAT(mouse.parents, ElementsAre(3, 0, 0, -1));
  EXPECT_THAT(mouse.mirror, ElementsAre(0, 2, 1, 3));
  EXPECT_EQ(mouse.root, 3);
}

TEST(SkeletonJson, NamesNullAndPartnersByName) {
  const Skeleton mouse = Read(R"({"joints":["nose","left ear","right ear"],"parents":[null,"nose","NOSE"]})");
  EXPECT_EQ(mouse.root, 0);
  EXPECT_THAT(mouse.parents, ElementsAre(-1, 0, 0));
  EXPECT_THAT(mouse.mirror, ElementsAre(0, 2, 1));
}

TEST(SkeletonJson, WhatIsNoSkeletonIsRefused) {
  EXPECT_THAT(ReadError("[]"), HasSubstr("expected a skeleton with joints and parents"));
  EXPECT_THAT(ReadError(R"({"joints":["a"]})"), HasSubstr("found an object with joints"));
  EXPECT_THAT(ReadError(R"({"joints":["a","b"],"parents":[-1]})"),
              HasSubstr("parents: expected 2 values, one per joint, found 1"));
  EXPECT_THAT(ReadError(R"({"joints":["a","b"],"parents":[-1,7]})"),
              AllOf(HasSubstr("parents[1]"), HasSubstr("-1 or the index of one of 2 joints")));
  EXPECT_THAT(ReadError(R"({"joints":["a","b"],"parents":[-1,"c"]})"), HasSubstr("the joints are a, b"));
  EXPECT_THAT(ReadError(R"({"joints":["a","b"],"parents":[1,0]})"),
              HasSubstr("one where root -1 is not one of 2 joints"));
  EXPECT_THAT(ReadError(R"({"joints":["a","b"],"parents":[-1,-1]})"), HasSubstr("b has no parent but is not the root"));
  EXPECT_THAT(ReadError(R"({"joints":["a","A"],"parents":[-1,0]})"), HasSubstr("there are two joints named A"));
  EXPECT_THAT(ReadError(R"({"joints":[],"parents":[]})"), HasSubstr("there are no joints"));
}

TEST(SkeletonJson, AFileIsKnownByItsExtension) {
  EXPECT_TRUE(IsSkeletonFile("a/mouse.JSON"));
  EXPECT_FALSE(IsSkeletonFile("coco-17"));
  EXPECT_FALSE(IsSkeletonFile(""));
}

}  // namespace
}  // namespace canonpose
