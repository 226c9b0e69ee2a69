// Folders for as long as they are needed.
#pragma once

#include <filesystem>
#include <system_error>

namespace canonpose {

/// Creates a folder whose name is `prefix` followed by six characters that make it unique; only its owner may use it.
/// Returns an empty path and sets `error` where that fails.
std::filesystem::path MakeUniqueFolder(const std::filesystem::path& prefix, std::error_code& error);

/// A new folder in the system's place for temporary files. The destructor removes it with everything in it.
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
