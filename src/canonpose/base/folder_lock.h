// One process at a time in a folder.
#pragma once

#include <filesystem>

namespace canonpose {

/// Holds a folder against other processes, and other objects of this class, by a lock on the file FOLDER/lock, which
/// names the process. The system gives the lock up with the process, however that ends, so the file that a killed one
/// leaves holds nobody up. Nothing is locked where the file system knows no locks.
class FolderLock {
 public:
  /// Throws Error(kBadInput) where another holds the folder, with its process and host, or nothing can be written
  /// there.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace canonpose
