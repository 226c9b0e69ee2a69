// UTF-8 to and from single characters.
#pragma once

#include <string>

namespace canonpose {

void AppendUtf8(char32_t character, std::string& text);

/// Bytes that are no UTF-8 become U+FFFD.
std::u32string FromUtf8(const std::string& text);

}  // namespace canonpose
