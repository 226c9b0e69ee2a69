// Failures that a user can do something about: one exception type, one line of text, one exit code.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace canonpose {

/// Exit codes of the command line, a contract with callers.
enum class ExitCode {
  kDone = 0,
  kUsage = 2,        ///< the command line is wrong
  kBadInput = 3,     ///< a file cannot be what it should be, or cannot be read or written
  kComputation = 4,  ///< the computation failed: diverged, too few views, ...
};

/// A failure told to the user in one line. Programmer faults are CANONPOSE_CHECKs instead.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// What is wrong with an input. Empty parts are left out of the message.
struct BadInput {
  std::string file;      ///< path as the user gave it
  std::string place;     ///< where in the file: "people[0].pose_keypoints_2d", "line 3", ...
  std::string expected;  ///< what should be there
  std::string found;     ///< what is there
  std::string advice;    ///< what to do about it
};

/// "FILE: PLACE: expected EXPECTED, found FOUND; ADVICE", always one line.
std::string FormatBadInput(const BadInput& bad_input);

/// Throws Error with ExitCode::kBadInput and the text of FormatBadInput().
[[noreturn]] void ThrowBadInput(const BadInput& bad_input);

/// Throws Error with ExitCode::kUsage.
template <typename... Args>
[[noreturn]] void ThrowUsage(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::kUsage, fmt::format(format, std::forward<Args>(args)...));
}

/// Throws Error with ExitCode::kComputation.
template <typename... Args>
[[noreturn]] void ThrowComputation(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ExitCode::kComputation, fmt::format(format, std::forward<Args>(args)...));
}

namespace internal {
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition, const std::string& message);
}  // namespace internal

}  // namespace canonpose

/// Aborts with file, line, the condition and a formatted message that should print the values compared.
#define CANONPOSE_CHECK(condition, ...)                                                                \
  do {                                                                                                 \
    if (!(condition)) {                                                                                \
      ::canonpose::internal::CheckFailed(__FILE__, __LINE__, #condition, fmt::format("" __VA_ARGS__)); \
    }                                                                                                  \
  } while (false)
