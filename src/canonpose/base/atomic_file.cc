#include "canonpose/base/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "canonpose/base/error.h"
#include "canonpose/base/temporary_folder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Syncs a file or folder. Returns the error number, 0 on success.
int Sync(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int result = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return result;
}

/// Syncs everything on a folder's file system: thousands of small files, one by one, would each wait for the disk.
/// Returns the error number, 0 on success and where the file system cannot.
int SyncAllBeside(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int result = ::syncfs(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return result == ENOSYS || result == EINVAL ? 0 : result;
}

/// The permissions that new files of this process are denied. The mask can only be read by setting it.
mode_t FileModeMask() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return mask;
}

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// The path that symbolic links at `path` lead to, whether it exists or not. Throws where the links form a circle.
fs::path ResolveLinks(const fs::path& path) {
  constexpr int kMaxLinks = 40;
  fs::path target = path;
  std::error_code error;
  for (int i = 0; fs::is_symlink(target, error); ++i) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) ThrowCannotWrite(path, error.value());
    if (i == kMaxLinks) ThrowCannotWrite(path, ELOOP);
    target = FolderOf(target) / next;  // an absolute `next` replaces the folder
  }
  return target;
}

/// Whether `path` can only be written to, not replaced: a pipe, a device, or a process's open file by its number.
bool IsStream(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_fifo(status) || fs::is_character_file(status) || fs::is_socket(status)) return true;
  if (!fs::exists(status) || fs::is_directory(status)) return false;
  const fs::path folder = fs::canonical(FolderOf(path), error);
  if (!error && folder.string().starts_with("/proc/")) return true;
  // /dev/stdout and the like are links to these numbers.
  const fs::path next = fs::read_symlink(path, error);
  return !error && next.string().starts_with("/proc/self/fd/");
}

/// Writes everything and closes the descriptor. Returns the error number, 0 on success.
int WriteAndClose(int descriptor, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t written = ::write(descriptor, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int failure = errno;
      ::close(descriptor);
      return failure;
    }
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::close(descriptor) == 0 ? 0 : errno;
}

}  // namespace

void ThrowCannotWrite(const fs::path& path, int error_number) {
  std::string advice = "choose another folder, or make this one writable";
  if (error_number == ENOSPC || error_number == EFBIG || error_number == EDQUOT) {
    advice = "free some space and run the command again; the file that was there before is untouched";
  }
  ThrowBadInput({path.string(), "", "a path that can be written to", std::strerror(error_number), advice});
}

void MakeDirectory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) ThrowCannotWrite(directory, error.value());
  if (!fs::is_directory(directory, error)) ThrowCannotWrite(directory, ENOTDIR);
}

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)) {
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (fs::is_directory(status)) ThrowCannotWrite(path_, EISDIR);
  if (IsStream(path_) || (fs::exists(status) && !fs::is_regular_file(status))) {
    ThrowBadInput({path_.string(), "", "a regular file or a new one", "a pipe or a device",
                   "choose a file: this output cannot be streamed"});
  }
  target_ = ResolveLinks(path_);
  std::string pattern = (FolderOf(target_) / (".new-" + target_.filename().string() + "-XXXXXX")).string();
  const int descriptor = ::mkstemp(pattern.data());
  if (descriptor < 0) ThrowCannotWrite(path_, errno);
  // mkstemp makes files private; give it the permissions that an ordinary file would have.
  ::fchmod(descriptor, 0666 & ~FileModeMask());
  ::close(descriptor);
  temporary_path_ = pattern;
}

AtomicFile::~AtomicFile() {
  if (!committed_) ::unlink(temporary_path_.c_str());
}

void AtomicFile::Commit() {
  if (const int failure = Sync(temporary_path_, O_RDWR); failure != 0) ThrowCannotWrite(path_, failure);
  if (::rename(temporary_path_.c_str(), target_.c_str()) != 0) ThrowCannotWrite(path_, errno);
  committed_ = true;
  Sync(FolderOf(target_), O_RDONLY | O_DIRECTORY);  // best effort: not every file system can sync a folder
}

AtomicFolder::AtomicFolder(const fs::path& path) : path_(path.has_filename() ? path : path.parent_path()) {
  std::error_code error;
  if (fs::exists(path_, error) && !(fs::is_directory(path_, error) && fs::is_empty(path_, error))) {
    ThrowBadInput({path_.string(), "", "an empty folder or a new one", "an existing file or folder",
                   "remove it, or choose another place"});
  }
  MakeDirectory(FolderOf(path_));
  temporary_path_ = MakeUniqueFolder(FolderOf(path_) / (".new-" + path_.filename().string() + "-"), error);
  if (error) ThrowCannotWrite(path_, error.value());
  // Give it the permissions that an ordinary folder would have.
  ::chmod(temporary_path_.c_str(), 0777 & ~FileModeMask());
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(temporary_path_, ignored);
}

void AtomicFolder::Commit() {
  if (const int failure = SyncAllBeside(temporary_path_); failure != 0) ThrowCannotWrite(path_, failure);
  std::error_code error;
  fs::rename(temporary_path_, path_, error);
  if (error) ThrowCannotWrite(path_, error.value());
  committed_ = true;
  Sync(FolderOf(path_), O_RDONLY | O_DIRECTORY);  // best effort: not every file system can sync a folder
}

void WriteFileAtomically(const fs::path& path, std::string_view contents) {
  if (IsStream(path)) {
    const int stream = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (stream < 0) ThrowCannotWrite(path, errno);
    if (const int failure = WriteAndClose(stream, contents); failure != 0) ThrowCannotWrite(path, failure);
    return;
  }
  AtomicFile file(path);
  const int descriptor = ::open(file.temporary_path().c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) ThrowCannotWrite(path, errno);
  if (const int failure = WriteAndClose(descriptor, contents); failure != 0) ThrowCannotWrite(path, failure);
  file.Commit();
}

void AppendLine(const fs::path& path, const std::string& line) {
  std::ofstream file(path, std::ios::app);
  errno = 0;
  file << line << "\n";
  file.close();
  if (!file) ThrowCannotWrite(path, errno == 0 ? EIO : errno);
}

void RequireOutputIsNotAnInput(const fs::path& output, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code error;
    if (output.empty() || input.empty() || !fs::equivalent(output, input, error) || error) continue;
    ThrowInvalidArgument("{} is an input and would be overwritten: write to another file", output.string());
  }
}

void RequireSeparateOutputs(const fs::path& one, const fs::path& other, std::string_view both) {
  if (one.empty() || fs::weakly_canonical(one) != fs::weakly_canonical(other)) return;
  ThrowInvalidArgument("{} cannot hold both {}: give two files", one.string(), both);
}

std::string ReadFile(const fs::path& path) {
  const auto fail = [&path](int error_number) {
    ThrowBadInput({path.string(), "", "a file that can be read", std::strerror(error_number), "check the path"});
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(errno);
  std::string contents;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && status.st_size > 0)
    contents.reserve(static_cast<std::size_t>(status.st_size));
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
