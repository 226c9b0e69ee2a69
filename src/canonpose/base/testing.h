// Shared by tests only: temporary folders, the data beside the checkout, and a matcher for one-line errors.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/temporary_folder.h"

namespace canonpose::testing {

using canonpose::TemporaryFolder;

/// The project's own small inputs.
inline std::filesystem::path TestData(const std::string& name) {
  return std::filesystem::path(CANONPOSE_TESTDATA) / name;
}

/// The data beside the checkout; see CANONPOSE_SKIP_WITHOUT_SHARED.
inline std::filesystem::path Shared(const std::string& name) { return std::filesystem::path(CANONPOSE_SHARED) / name; }

/// Runs `action` and returns the message of the Error it throws, after checking its kind and that it is one line.
template <typename Action>
std::string ErrorOf(ErrorKind kind, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return "";
}

/// Collects the messages of this thread's work during its lifetime, one line each; warnings begin with "warning: ".
class CollectedMessages {
 public:
  CollectedMessages() : scope_(Collect()) {}
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Callbacks Collect() {
    Callbacks callbacks;
    callbacks.message = [this](MessageLevel level, const std::string& text) {
      text_ += (level == MessageLevel::kWarning ? "warning: " : "") + text + '\n';
    };
    return callbacks;
  }

  std::string text_;
  CallbackScope scope_;
};

}  // namespace canonpose::testing

/// Skips a test of whole captures in the sanitizer build, where it takes minutes and runs no code that shorter tests do
/// not run.
#ifdef CANONPOSE_SANITIZED
#define CANONPOSE_SKIP_UNDER_SANITIZERS() GTEST_SKIP() << "takes minutes under AddressSanitizer"
#else
#define CANONPOSE_SKIP_UNDER_SANITIZERS() static_cast<void>(0)
#endif

/// Skips the test with a message where the file beside the checkout is missing.
#define CANONPOSE_SKIP_WITHOUT_SHARED(name)                               \
  if (!std::filesystem::exists(::canonpose::testing::Shared(name))) {     \
    GTEST_SKIP() << ::canonpose::testing::Shared(name) << " is not here"; \
  }
