// Messages to the person at the terminal: stderr, and a log file where one is open. Results go to stdout, never through
// here.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace canonpose {

/// One line at the given level; a terminal's progress line is cleared first.
void LogInfoText(const std::string& text);
void LogWarningText(const std::string& text);

template <typename... Args>
void LogInfo(fmt::format_string<Args...> format, Args&&... args) {
  LogInfoText(fmt::format(format, std::forward<Args>(args)...));
}

template <typename... Args>
void LogWarning(fmt::format_string<Args...> format, Args&&... args) {
  LogWarningText(fmt::format(format, std::forward<Args>(args)...));
}

/// While it lives, every logged line is appended to `path` too, with the time.
class LogFile {
 public:
  /// Throws Error(kBadInput) where the file cannot be opened.
  explicit LogFile(const std::filesystem::path& path);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;
};

/// Writes to the log file alone: what would be too much for the person at the terminal.
void LogToFileOnly(const std::string& text);

}  // namespace canonpose
