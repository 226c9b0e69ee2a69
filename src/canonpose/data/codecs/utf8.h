// UTF-8 to and from single characters.
#pragma once

#include <string>

namespace canonpose {

/// Appends one character.
void AppendUtf8(char32_t character, std::string& text);

/// The characters of a text. A byte that cannot start a character, or whose character is cut off by the end of the
/// text, becomes U+FFFD. Continuation bytes are not checked.
std::u32string FromUtf8(const std::string& text);

}  // namespace canonpose
