#include "canonpose/pipeline/path_fingerprint.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMebibyte = 1U << 20;
/// Reading larger files, such as videos of an hour, would take longer than a run in which nothing is to be done.
constexpr std::uintmax_t kLargestWhole = 256 * kMebibyte;

[[noreturn]] void ThrowUnreadable(const fs::path& path, const std::error_code& error) {
  ThrowBadInput({path.string(), "", "a file or folder that can be read", error ? error.message() : "a read error",
                 "check the path and its permissions"});
}

/// Adds `size` bytes from `begin` on.
void AddPart(std::ifstream& stream, std::uintmax_t begin, std::uintmax_t size, const fs::path& path,
             Fingerprint& fingerprint) {
  std::string part(static_cast<std::size_t>(kMebibyte), '\0');
  stream.seekg(static_cast<std::streamoff>(begin));
  for (std::uintmax_t left = size; left > 0;) {
    const std::uintmax_t now = std::min(left, kMebibyte);
    if (!stream.read(part.data(), static_cast<std::streamsize>(now))) ThrowUnreadable(path, {});
    fingerprint.Add(part.data(), static_cast<std::size_t>(now));
    left -= now;
  }
}

void AddFile(const fs::path& path, Fingerprint& fingerprint) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) ThrowUnreadable(path, error);
  fingerprint.Add(fmt::format("file {}", size));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) ThrowUnreadable(path, std::make_error_code(std::errc::permission_denied));
  if (size <= kLargestWhole) return AddPart(stream, 0, size, path, fingerprint);
  AddPart(stream, 0, kMebibyte, path, fingerprint);
  AddPart(stream, size - kMebibyte, kMebibyte, path, fingerprint);
  const auto modified = fs::last_write_time(path, error);
  if (error) ThrowUnreadable(path, error);
  fingerprint.Add(fmt::format("modified {}", modified.time_since_epoch().count()));
}

void AddPath(const fs::path& path, Fingerprint& fingerprint) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return AddFile(path, fingerprint);
  std::vector<fs::path> names;
  fs::directory_iterator entries(path, error);
  if (error) ThrowUnreadable(path, error);
  for (const fs::directory_entry& entry : entries) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  for (const fs::path& name : names) {
    if (name.string().starts_with('.') || name == "lock") continue;
    fingerprint.Add(name.string());
    AddPath(path / name, fingerprint);
  }
  fingerprint.Add("end of folder");
}

}  // namespace

std::string FingerprintOfPath(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return "";
  Fingerprint fingerprint;
  AddPath(path, fingerprint);
  return fmt::format("{:016x}", fingerprint.value());
}

const std::string& FingerprintCache::Of(const fs::path& path) {
  const auto found = known_.find(path);
  if (found != known_.end()) return found->second;
  return known_.emplace(path, FingerprintOfPath(path)).first->second;
}

}  // namespace canonpose
