#include "canonpose/data/codecs/utf8.h"

#include <cstddef>

namespace canonpose {

void AppendUtf8(char32_t character, std::string& text) {
  const auto byte = [&](char32_t value) { text += static_cast<char>(value); };
  if (character < 0x80) {
    byte(character);
  } else if (character < 0x800) {
    byte(0xC0 | character >> 6);
    byte(0x80 | (character & 0x3F));
  } else if (character < 0x10000) {
    byte(0xE0 | character >> 12);
    byte(0x80 | (character >> 6 & 0x3F));
    byte(0x80 | (character & 0x3F));
  } else {
    byte(0xF0 | (character >> 18 & 0x07));
    byte(0x80 | (character >> 12 & 0x3F));
    byte(0x80 | (character >> 6 & 0x3F));
    byte(0x80 | (character & 0x3F));
  }
}

std::u32string FromUtf8(const std::string& text) {
  constexpr char32_t kReplacement = 0xFFFD;
  std::u32string characters;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    const std::size_t more =
        lead < 0x80 ? 0 : std::size_t{lead >= 0xC0} + std::size_t{lead >= 0xE0} + std::size_t{lead >= 0xF0};
    if (lead >= 0x80 && (more == 0 || i + more > text.size())) {
      characters += kReplacement;
      continue;
    }
    char32_t character = more == 0 ? lead : lead & (0x3F >> more);
    for (std::size_t k = 0; k < more; ++k) character = character << 6 | (static_cast<unsigned char>(text[i++]) & 0x3F);
    characters += character;
  }
  return characters;
}

}  // namespace canonpose
