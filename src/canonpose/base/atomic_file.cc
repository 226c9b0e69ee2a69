#include "canonpose/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Syncs a file or folder; the error number, 0 where it went well.
int Sync(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int result = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return result;
}

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

}  // namespace

void ThrowCannotWrite(const fs::path& path, int error_number) {
  std::string advice = "choose another place with -o, or make this one writable";
  if (error_number == ENOSPC || error_number == EFBIG || error_number == EDQUOT) {
    advice = "free some space and run the command again; the file that was there before is untouched";
  }
  ThrowBadInput({path.string(), "", "a place that can be written", std::strerror(error_number), advice});
}

void MakeDirectory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) ThrowCannotWrite(directory, error.value());
  if (!fs::is_directory(directory)) ThrowCannotWrite(directory, ENOTDIR);
}

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)) {
  if (fs::is_directory(path_)) ThrowCannotWrite(path_, EISDIR);
  std::string pattern = (FolderOf(path_) / (".new-" + path_.filename().string() + "-XXXXXX")).string();
  const int descriptor = ::mkstemp(pattern.data());
  if (descriptor < 0) ThrowCannotWrite(path_, errno);
  // mkstemp makes files private; give the permissions an ordinary file would have.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor, 0666 & ~mask);
  ::close(descriptor);
  temporary_path_ = pattern;
}

AtomicFile::~AtomicFile() {
  if (!committed_) ::unlink(temporary_path_.c_str());
}

void AtomicFile::Commit() {
  if (const int failure = Sync(temporary_path_, O_RDWR); failure != 0) ThrowCannotWrite(path_, failure);
  if (::rename(temporary_path_.c_str(), path_.c_str()) != 0) ThrowCannotWrite(path_, errno);
  committed_ = true;
  Sync(FolderOf(path_), O_RDONLY | O_DIRECTORY);  // best effort: not every file system can sync a folder
}

void WriteFileAtomically(const fs::path& path, std::string_view contents) {
  AtomicFile file(path);
  const int descriptor = ::open(file.temporary_path().c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) ThrowCannotWrite(path, errno);
  while (!contents.empty()) {
    const ssize_t written = ::write(descriptor, contents.data(), contents.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      const int failure = errno;
      ::close(descriptor);
      ThrowCannotWrite(path, failure);
    }
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(descriptor) != 0) ThrowCannotWrite(path, errno);
  file.Commit();
}

void AppendLine(const fs::path& path, const std::string& line) {
  std::ofstream file(path, std::ios::app);
  errno = 0;
  file << line << "\n";
  file.close();
  if (!file) ThrowCannotWrite(path, errno == 0 ? EIO : errno);
}

std::string ReadFile(const fs::path& path) {
  const auto fail = [&path](int error_number) {
    ThrowBadInput({path.string(), "", "a file that can be read", std::strerror(error_number), "check the path"});
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(errno);
  std::string contents;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && status.st_size > 0) contents.reserve(static_cast<std::size_t>(status.st_size));
  char buffer[1 << 16];
  while (true) {
    const ssize_t count = ::read(descriptor, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int failure = errno;
      ::close(descriptor);
      fail(failure);
    }
    if (count == 0) break;
    contents.append(buffer, static_cast<std::size_t>(count));
  }
  ::close(descriptor);
  return contents;
}

}  // namespace canonpose
