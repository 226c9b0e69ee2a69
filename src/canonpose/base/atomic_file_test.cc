#include "canonpose/base/atomic_file.h"

#include <csignal>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(AtomicFile, ReplacesWholeFiles) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a", "old");
  WriteFileAtomically(folder / "a", "new");
  EXPECT_EQ(ReadFile(folder / "a"), "new");
}

TEST(AtomicFile, LeavesNothingBehindWithoutCommit) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a", "old");
  {
    const AtomicFile file(folder / "a");
    std::ofstream(file.temporary_path()) << "half";
  }
  EXPECT_EQ(ReadFile(folder / "a"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(RequireOutputIsNotAnInput, KnowsAFileByWhateverName) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.h5", "x");
  std::filesystem::create_symlink(folder / "a.h5", folder / "link.h5");
  RequireOutputIsNotAnInput(folder / "new.h5", {folder / "a.h5", "", folder / "new.h5"});
  RequireOutputIsNotAnInput(folder / "a.h5", {folder / "none.h5"});
  for (const std::filesystem::path& output : {folder / "a.h5", folder / "link.h5", folder / "./a.h5"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                        [&] {
                          RequireOutputIsNotAnInput(output, {"", folder / "a.h5"});
                        }),
                ::testing::HasSubstr("would be overwritten"));
  }
}

TEST(RequireSeparateOutputs, KnowsAFileByWhateverName) {
  const TemporaryFolder folder;
  RequireSeparateOutputs(folder / "a.h5", folder / "a.json", "data and report");
  RequireSeparateOutputs(folder / "a.h5", "", "data and report");
  RequireSeparateOutputs("", "", "data and report");
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] { RequireSeparateOutputs(folder / "a.h5", folder / "./a.h5", "data and report"); }),
              HasSubstr("cannot hold both data and report: give two files"));
}

TEST(AtomicFile, MissingFolderIsOneLine) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { WriteFileAtomically("/nonexistent/a", ""); }),
              AllOf(HasSubstr("/nonexistent/a"), HasSubstr("No such file or directory")));
}

TEST(AtomicFile, FullDiskKeepsTheOldFile) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a", "old");
  // A limit on the size of files makes writing fail as a full disk does.
  ASSERT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  rlimit old_limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const rlimit limit{1000, old_limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string message =
      ErrorOf(ErrorKind::kBadInput, [&] { WriteFileAtomically(folder / "a", std::string(5000, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  EXPECT_THAT(message, HasSubstr("free some space"));
  EXPECT_EQ(ReadFile(folder / "a"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(AtomicFile, WritesToWhatALinkPointsTo) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  MakeDirectory(folder / "below");
  WriteFileAtomically(folder / "below/a", "old");
  fs::create_symlink("below/a", folder / "link");
  fs::create_symlink("link", folder / "link to link");
  WriteFileAtomically(folder / "link to link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link to link"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(ReadFile(folder / "below/a"), "new");
  fs::create_symlink(folder / "below/b", folder / "dangling");
  WriteFileAtomically(folder / "dangling", "first");
  EXPECT_EQ(ReadFile(folder / "below/b"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "below"), {}), 2);
  fs::create_symlink("circle", folder / "circle");
  ErrorOf(ErrorKind::kBadInput, [&] { WriteFileAtomically(folder / "circle", ""); });
}

TEST(AtomicFile, PipesAndDevicesAreWrittenToAndNeverReplaced) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  WriteFileAtomically(folder / "pipe", "hello");
  char buffer[16] = {};
  EXPECT_EQ(::read(reader, buffer, sizeof buffer), 5);
  ::close(reader);
  EXPECT_STREQ(buffer, "hello");
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AtomicFile file(folder / "pipe"); }),
              HasSubstr("expected a regular file or a new one"));
  // Through a link, so that a bug here could not replace the machine's own device.
  fs::create_symlink("/dev/null", folder / "null");
  WriteFileAtomically(folder / "null", "gone");
  EXPECT_TRUE(fs::is_symlink(folder / "null"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AtomicFile file(folder / "null"); }), HasSubstr("device"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteFileAtomically(folder.path(), ""); }), HasSubstr("directory"));
}

TEST(AtomicFile, TooLongNamesAreOneLine) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteFileAtomically(folder / std::string(300, 'x'), ""); }),
              HasSubstr("File name too long"));
}

TEST(AtomicFolder, AppearsWithCommitAndReplacesNothing) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  {
    const AtomicFolder unfinished(folder / "new");
    EXPECT_EQ(unfinished.temporary_path().parent_path(), folder.path());
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  {
    AtomicFolder made(folder / "new");
    std::ofstream(made.temporary_path() / "a") << "a";
    EXPECT_FALSE(fs::exists(folder / "new"));
    made.Commit();
  }
  EXPECT_EQ(ReadFile(folder / "new/a"), "a");
  MakeDirectory(folder / "ordinary");
  EXPECT_EQ(fs::status(folder / "new").permissions(), fs::status(folder / "ordinary").permissions());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AtomicFolder(folder / "new"); }),
              HasSubstr("an existing file or folder"));
  WriteFileAtomically(folder / "file", "");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AtomicFolder(folder / "file/below"); }), HasSubstr("file"));
}

TEST(MakeDirectory, RefusesAFileInTheWay) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a", "");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeDirectory(folder / "a"); }), HasSubstr("/a"));
}

}  // namespace
}  // namespace canonpose
