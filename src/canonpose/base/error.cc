#include "canonpose/base/error.h"

#include <algorithm>

namespace canonpose {

std::string FormatBadInput(const BadInput& bad_input) {
  std::string text = bad_input.file;
  const auto append = [&text](const char* separator, const std::string& part) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  append(": ", bad_input.place);
  append(": ", bad_input.expected.empty() ? "" : "expected " + bad_input.expected);
  append(bad_input.expected.empty() ? ": " : ", ", bad_input.found.empty() ? "" : "found " + bad_input.found);
  append("; ", bad_input.advice);
  // Text from a file may contain anything, but a message is one line.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

void ThrowBadInput(const BadInput& bad_input) { throw Error(ErrorKind::kBadInput, FormatBadInput(bad_input)); }

namespace internal {
void CheckFailed(const char* file, int line, const char* condition, const std::string& message) {
  throw std::logic_error(
      fmt::format("{}:{}: check failed: {}{}{}", file, line, condition, message.empty() ? "" : ": ", message));
}
}  // namespace internal

}  // namespace canonpose
