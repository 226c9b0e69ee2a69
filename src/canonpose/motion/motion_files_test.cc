#include "canonpose/motion/motion_files.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TestData;

TEST(FindMotionFiles, InFoldersAndByThemselves) {
  const TemporaryFolder folder;
  const auto found = [&](const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& name : names) paths.push_back(folder / name);
    std::vector<std::string> clips;
    for (const auto& path : FindMotionFiles(paths)) clips.push_back(path.lexically_relative(folder.path()).string());
    return clips;
  };
  for (const char* name : {"a", "a/b", "empty"}) MakeDirectory(folder / name);
  for (const char* name : {"a/2.amc", "a/b/1.BVH", "a/2.asf", "3.bvh", "a/notes.txt"}) std::ofstream(folder / name);
  EXPECT_EQ(found({"a", "3.bvh"}), (std::vector<std::string>{"3.bvh", "a/2.amc", "a/b/1.BVH"}));
  EXPECT_EQ(found({"a/2.amc", "a"}), (std::vector<std::string>{"a/2.amc", "a/b/1.BVH"}));
  for (const char* name : {"empty", "nowhere", "a/notes.txt"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { found({"a", name}); }), HasSubstr(name));
  }
}

TEST(ReadMotion, TakesTheReaderByTheExtension) {
  EXPECT_EQ(ReadMotion(TestData("mocap/tiny.amc")).fps, 120.0);
  EXPECT_EQ(ReadMotion(TestData("mocap/tiny.bvh")).joint_count(), 5);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { ReadMotion("notes.txt"); }), HasSubstr("found .txt"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { ReadMotion("notes"); }), HasSubstr("without an extension"));
}

}  // namespace
}  // namespace canonpose
