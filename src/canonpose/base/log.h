// Messages of the work in progress. They go to the caller (callbacks.h), and also to a file where one is open.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/callbacks.h"

namespace canonpose {

template <typename... Args>
void LogInfo(fmt::format_string<Args...> format, Args&&... args) {
  internal::SendMessage(MessageLevel::kInfo, fmt::format(format, std::forward<Args>(args)...));
}

template <typename... Args>
void LogWarning(fmt::format_string<Args...> format, Args&&... args) {
  internal::SendMessage(MessageLevel::kWarning, fmt::format(format, std::forward<Args>(args)...));
}

/// During its lifetime, the messages of this thread's work are also appended to a file, with the time.
class LogFile {
 public:
  /// Throws Error(kBadInput) where the file cannot be opened.
  explicit LogFile(const std::filesystem::path& path);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// Writes to the file only: details that would be too much for the caller.
  void Write(const std::string& text);

 private:
  struct Sink;
  std::unique_ptr<Sink> sink_;
  std::unique_ptr<CallbackScope> scope_;
};

}  // namespace canonpose
