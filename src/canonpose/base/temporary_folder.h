// A folder for as long as it is needed.
#pragma once

#include <filesystem>

namespace canonpose {

/// A new folder below the system's place for temporary files, removed with all it holds.
class TemporaryFolder {
 public:
  /// Throws Error(kBadInput) where none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace canonpose
