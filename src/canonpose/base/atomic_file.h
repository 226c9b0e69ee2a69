// Files that appear whole or not at all: a reader, a crash or a full disk never sees half of one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace canonpose {

/// Creates `directory` and its parents. Throws Error(kBadInput) where that fails or something else stands there.
void MakeDirectory(const std::filesystem::path& directory);

/// A temporary file beside `path` that Commit() moves into place; without Commit() it is removed and `path` is
/// untouched. Where `path` is a symbolic link, the file it points to is replaced, and the link stays.
class AtomicFile {
 public:
  /// Throws Error(kBadInput) where the folder does not exist or cannot be written, or something stands at `path` that
  /// is no regular file.
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write; exists, empty.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_path_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Syncs the temporary file to disk and renames it to `path`. Throws Error(kBadInput), the old file kept.
  void Commit();

 private:
  std::filesystem::path path_;    // as the caller gave it
  std::filesystem::path target_;  // links resolved
  std::filesystem::path temporary_path_;
  bool committed_ = false;
};

/// A folder that is filled beside its place and moved there by Commit(); without Commit() it is removed. Nothing is
/// replaced but an empty folder.
class AtomicFolder {
 public:
  /// Throws Error(kBadInput) where there is something at `path` already, or nothing can be written there.
  explicit AtomicFolder(const std::filesystem::path& path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Where to write; exists, empty.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_path_; }
  /// Throws Error(kBadInput).
  void Commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_path_;
  bool committed_ = false;
};

/// Writes `contents` as a whole; straight into what is there where that is a pipe or a device such as /dev/stdout.
/// Throws Error(kBadInput), with the system's reason and the old file kept.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view contents);

/// Adds a line to a file, made where there is none. Throws Error(kBadInput).
void AppendLine(const std::filesystem::path& path, const std::string& line);

/// The whole file. Throws Error(kBadInput) where it cannot be read.
std::string ReadFile(const std::filesystem::path& path);

/// Throws the Error(kBadInput) that tells why `path` could not be written, from the system's error number.
[[noreturn]] void ThrowCannotWrite(const std::filesystem::path& path, int error_number);

}  // namespace canonpose
