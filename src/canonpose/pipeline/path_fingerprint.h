// A fingerprint of files, to see whether they are the same as when they were used.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace canonpose {

/// Of the contents of a file, or of all files in a folder and below it with their names; hidden files and locks do not
/// count. Files of more than 256 MiB are known by their size, beginning, end and time of modification. Empty where
/// there is nothing. Throws Error(kBadInput) where something cannot be read.
std::string FingerprintOfPath(const std::filesystem::path& path);

/// The same, each path being read once, until it is said to have changed.
class FingerprintCache {
 public:
  const std::string& Of(const std::filesystem::path& path);
  void Forget() { known_.clear(); }

 private:
  std::map<std::filesystem::path, std::string> known_;
};

}  // namespace canonpose
