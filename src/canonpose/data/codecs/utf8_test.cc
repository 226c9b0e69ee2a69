#include "canonpose/data/codecs/utf8.h"

#include <string>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Utf8, CharactersOfOneToFourBytesComeBack) {
  const std::string text = "a\u00DF\u20AC\U0001F938";
  const std::u32string characters = FromUtf8(text);
  EXPECT_EQ(characters, (std::u32string{U'a', 0xDF, 0x20AC, 0x1F938}));
  std::string back;
  for (const char32_t character : characters) AppendUtf8(character, back);
  EXPECT_EQ(back, text);
}

TEST(Utf8, StrayAndMissingBytesAreReplaced) {
  EXPECT_EQ(FromUtf8("a\x80z"), (std::u32string{U'a', 0xFFFD, U'z'}));
  EXPECT_EQ(FromUtf8("a\xE2\x82"), (std::u32string{U'a', 0xFFFD, 0xFFFD}));
}

}  // namespace
}  // namespace canonpose
