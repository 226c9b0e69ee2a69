#include "canonpose/base/folder_lock.h"

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(FolderLock, ASecondOneIsRefusedUntilTheFirstEnds) {
  const TemporaryFolder folder;
  std::optional<FolderLock> first(folder.path());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { const FolderLock second(folder.path()); }),
              AllOf(HasSubstr(folder.path().string() + ": expected a folder in which nothing else is at work"),
                    HasSubstr(fmt::format("found process {} on ", ::getpid())), HasSubstr("choose another folder")));
  first.reset();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const FolderLock third(folder.path());
}

TEST(FolderLock, AKilledProcessHoldsNobodyUp) {
  const TemporaryFolder folder;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const FolderLock lock(folder.path());
    (void)!::write(ready[1], "x", 1);
    while (true) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { const FolderLock lock(folder.path()); }),
              HasSubstr(fmt::format("found process {} on ", child)));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(ready[0]);
  ::close(ready[1]);
  EXPECT_THAT(ReadFile(folder / "lock"), HasSubstr(fmt::format("process {} on ", child))) << "it is left behind";
  const FolderLock lock(folder.path());
  EXPECT_THAT(ReadFile(folder / "lock"), HasSubstr(fmt::format("process {} on ", ::getpid())));
}

TEST(FolderLock, AFolderThatCannotBeWrittenIsOneLine) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { const FolderLock lock("/proc/1"); }), HasSubstr("/proc/1/lock"));
}

}  // namespace
}  // namespace canonpose
