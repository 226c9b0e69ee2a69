// Failures that a caller can do something about: one exception type, its kind, one line of text.
//
// Messages are read by users of the command line and by users of the library, so they refer to an option by the name of
// its field, in backquotes: "give `image_size`". The command line replaces it by the option that sets the field.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace canonpose {

enum class ErrorKind {
  kInvalidArgument,  ///< an option or a combination of options makes no sense
  kBadInput,         ///< a file is not as it should be, or cannot be read or written
  kComputation,      ///< the computation failed: it diverged, there are too few views, ...
  kStopped,          ///< the caller stopped work that cannot be continued later (Callbacks::stop)
};

/// A failure that the user can act on, described in one line. A bug in this library is a std::logic_error
/// (CANONPOSE_CHECK).
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
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

/// Throws Error(kBadInput) with the text of FormatBadInput().
[[noreturn]] void ThrowBadInput(const BadInput& bad_input);

/// Throws Error(kInvalidArgument).
template <typename... Args>
[[noreturn]] void ThrowInvalidArgument(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ErrorKind::kInvalidArgument, fmt::format(format, std::forward<Args>(args)...));
}

/// Throws Error(kComputation).
template <typename... Args>
[[noreturn]] void ThrowComputation(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(ErrorKind::kComputation, fmt::format(format, std::forward<Args>(args)...));
}

namespace internal {
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition, const std::string& message);
}  // namespace internal

}  // namespace canonpose

/// Throws std::logic_error with file, line, the condition and a formatted message, which should contain the values
/// compared.
#define CANONPOSE_CHECK(condition, ...)                                                                \
  do {                                                                                                 \
    if (!(condition)) {                                                                                \
      ::canonpose::internal::CheckFailed(__FILE__, __LINE__, #condition, fmt::format("" __VA_ARGS__)); \
    }                                                                                                  \
  } while (false)
