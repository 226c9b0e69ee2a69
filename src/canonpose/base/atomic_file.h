// Files that appear whole or not at all: a reader, a crash or a full disk never sees half of one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// Creates `directory` and its parents. Throws Error(kBadInput) where that fails, such as because a file is in the way.
void MakeDirectory(const std::filesystem::path& directory);

/// A temporary file beside `path` that Commit() moves into place; without Commit() it is removed and `path` is
/// untouched. Where `path` is a symbolic link, the file it points to is replaced, and the link stays.
class AtomicFile {
 public:
  /// Throws Error(kBadInput) where the folder does not exist or cannot be written to, or `path` is something other than
  /// a regular file.
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write: an empty file.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_path_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Syncs the temporary file to disk and renames it to `path`. Throws Error(kBadInput) where that fails; the old file
  /// is then kept.
  void Commit();

 private:
  std::filesystem::path path_;    // as the caller gave it
  std::filesystem::path target_;  // links resolved
  std::filesystem::path temporary_path_;
  bool committed_ = false;
};

/// A folder that is filled beside its final place and moved there by Commit(); without Commit() it is removed. Only an
/// empty folder is ever replaced.
class AtomicFolder {
 public:
  /// Throws Error(kBadInput) where something other than an empty folder exists at `path`, or nothing can be written
  /// there.
  explicit AtomicFolder(const std::filesystem::path& path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Where to write: an empty folder.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_path_; }
  /// Syncs the files to disk and moves the folder to `path`. Throws Error(kBadInput) where that fails.
  void Commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_path_;
  bool committed_ = false;
};

/// Writes `contents` through an AtomicFile, or directly where `path` is a pipe or a device such as /dev/stdout. Throws
/// Error(kBadInput) with the system's reason where that fails; the old file is then kept.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view contents);

/// Appends a line to a file, which is created if needed. Throws Error(kBadInput).
void AppendLine(const std::filesystem::path& path, const std::string& line);

/// Throws Error(kInvalidArgument) where `output` is also one of the `inputs`, under whatever name: to be called before
/// any work is done. Empty paths are ignored, and so are inputs that do not exist.
void RequireOutputIsNotAnInput(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);

/// Throws Error(kInvalidArgument) where two outputs are one file; `both` says what it cannot hold. An empty path is no
/// output.
void RequireSeparateOutputs(const std::filesystem::path& one, const std::filesystem::path& other,
                            std::string_view both);

/// The whole file. Throws Error(kBadInput) where it cannot be read.
std::string ReadFile(const std::filesystem::path& path);

/// Throws the Error(kBadInput) that says why `path` could not be written, from the system's error number.
[[noreturn]] void ThrowCannotWrite(const std::filesystem::path& path, int error_number);

}  // namespace canonpose
