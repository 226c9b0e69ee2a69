#include "canonpose/pipeline/path_fingerprint.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

void Write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

TEST(PathFingerprint, IsThatOfTheContents) {
  const TemporaryFolder folder;
  Write(folder / "a", "one");
  const std::string one = FingerprintOfPath(folder / "a");
  EXPECT_EQ(one.size(), 16U);
  Write(folder / "b", "one");
  EXPECT_EQ(FingerprintOfPath(folder / "b"), one) << "neither name nor time count";
  Write(folder / "a", "two");
  EXPECT_NE(FingerprintOfPath(folder / "a"), one);
  EXPECT_EQ(FingerprintOfPath(folder / "gone"), "");
}

TEST(PathFingerprint, OfAFolderHasNamesAndContentsOfAllFiles) {
  const TemporaryFolder folder;
  Write(folder / "one/cam1/0.json", "a");
  Write(folder / "one/cam2/0.json", "b");
  const std::string before = FingerprintOfPath(folder / "one");
  fs::copy(folder / "one", folder / "two", fs::copy_options::recursive);
  EXPECT_EQ(FingerprintOfPath(folder / "two"), before);
  Write(folder / "one/.cam1.journal", "hidden");
  Write(folder / "one/lock", "1");
  EXPECT_EQ(FingerprintOfPath(folder / "one"), before);
  Write(folder / "one/cam2/0.json", "c");
  EXPECT_NE(FingerprintOfPath(folder / "one"), before);
  fs::rename(folder / "two/cam2/0.json", folder / "two/cam2/1.json");
  EXPECT_NE(FingerprintOfPath(folder / "two"), before);
  fs::rename(folder / "two/cam2/1.json", folder / "two/cam1/0.json.old");
  EXPECT_NE(FingerprintOfPath(folder / "two"), before);
}

TEST(PathFingerprint, OfALargeFileReadsItsEnds) {
  const TemporaryFolder folder;
  const fs::path path = folder / "large";
  Write(path, "begin");
  fs::resize_file(path, (std::uintmax_t{256} << 20) + 10);  // with a hole, so that it takes no room
  const fs::file_time_type time = fs::last_write_time(path);
  const std::string before = FingerprintOfPath(path);
  {
    std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(-1, std::ios::end);
    stream << "x";
  }
  fs::last_write_time(path, time);
  EXPECT_NE(FingerprintOfPath(path), before);
}

TEST(PathFingerprint, IsReadOnceUntilForgotten) {
  const TemporaryFolder folder;
  Write(folder / "a", "one");
  FingerprintCache cache;
  const std::string before = cache.Of(folder / "a");
  Write(folder / "a", "two");
  EXPECT_EQ(cache.Of(folder / "a"), before);
  cache.Forget();
  EXPECT_NE(cache.Of(folder / "a"), before);
}

}  // namespace
}  // namespace canonpose
