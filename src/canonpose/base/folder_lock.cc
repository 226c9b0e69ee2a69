#include "canonpose/base/folder_lock.h"

#include <array>
#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Whether the open file is still the one at `path`: its last owner may have removed it.
bool IsAt(int descriptor, const fs::path& path) {
  struct stat open_file {};
  struct stat named_file {};
  return ::fstat(descriptor, &open_file) == 0 && ::stat(path.c_str(), &named_file) == 0 &&
         open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

std::string DescribeThisProcess() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {"an unknown host"};
  return fmt::format("process {} on {}", ::getpid(), host.data());
}

/// What the file says of its owner.
std::string DescribeOwner(int descriptor) {
  std::array<char, 300> text{};
  const ssize_t count = ::pread(descriptor, text.data(), text.size(), 0);
  const std::string owner(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  return owner.empty() ? "another process" : owner.substr(0, owner.find('\n'));
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : path_(folder / "lock") {
  while (true) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) ThrowCannotWrite(path_, errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      const std::string owner = DescribeOwner(descriptor_);
      if (!is_held) return;  // this file system knows no locks
      ::close(descriptor_);
      ThrowBadInput({folder.string(), "", "a folder in which nothing else is at work", owner,
                     "wait until it has finished or stop it, or choose another folder"});
    }
    if (IsAt(descriptor_, path_)) break;
    ::close(descriptor_);
  }
  const std::string owner = DescribeThisProcess() + "\n";
  // For people only: on a full disk the file stays empty and locks all the same.
  const bool is_empty = ::ftruncate(descriptor_, 0) == 0;
  if (is_empty && ::pwrite(descriptor_, owner.data(), owner.size(), 0) < 0) (void)::ftruncate(descriptor_, 0);
}

FolderLock::~FolderLock() {
  ::unlink(path_.c_str());  // before the lock goes: whoever gets it then notices that the file is another
  ::close(descriptor_);
}

}  // namespace canonpose
