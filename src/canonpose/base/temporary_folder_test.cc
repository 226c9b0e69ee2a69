#include "canonpose/base/temporary_folder.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

TEST(TemporaryFolder, IsRemovedWithWhatItHolds) {
  namespace fs = std::filesystem;
  fs::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    fs::create_directory(folder / "below");
    std::ofstream(folder / "below/file") << "text";
    EXPECT_TRUE(fs::exists(path / "below/file"));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(MakeUniqueFolder, MakesAnotherEachTimeOrSaysWhyNot) {
  const TemporaryFolder folder;
  std::error_code error;
  const std::filesystem::path a = MakeUniqueFolder(folder / "part-", error);
  ASSERT_FALSE(error) << error.message();
  const std::filesystem::path b = MakeUniqueFolder(folder / "part-", error);
  ASSERT_FALSE(error) << error.message();
  EXPECT_NE(a, b);
  EXPECT_TRUE(a.filename().string().starts_with("part-"));
  EXPECT_TRUE(std::filesystem::is_directory(a) && std::filesystem::is_directory(b));
  EXPECT_TRUE(MakeUniqueFolder("/nonexistent/part-", error).empty());
  EXPECT_EQ(error.value(), ENOENT);
}

}  // namespace
}  // namespace canonpose
