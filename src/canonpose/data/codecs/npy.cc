#include "canonpose/data/codecs/npy.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/utf8.h"

namespace canonpose::npy {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied as they are, little-endian");

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;

struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t data_offset = 0;
};

/// The file and the array, for messages.
struct Place {
  const std::string& file;
  const std::string& name;
  [[noreturn]] void Fail(const std::string& expected, const std::string& found, const std::string& advice = "") const {
    ThrowBadInput({file, "array " + name, expected, found, advice});
  }
  [[noreturn]] void FailHeader() const { Fail("a NumPy array", "a damaged header", "save the file again"); }
};

/// The text after `'key':` in the header's Python dictionary, without leading blanks.
std::string_view After(std::string_view header, const std::string& key, const Place& place) {
  const std::size_t at = header.find("'" + key + "'");
  if (at == std::string_view::npos) place.FailHeader();
  const std::size_t colon = header.find(':', at);
  const std::size_t value = colon == std::string_view::npos ? colon : header.find_first_not_of(' ', colon + 1);
  if (value == std::string_view::npos) place.FailHeader();
  return header.substr(value);
}

/// "(3, 4)", "(3,)" or "()".
std::vector<std::size_t> ParseShape(std::string_view text, const Place& place) {
  const std::size_t end = text.find(')');
  if (text.empty() || text.front() != '(' || end == std::string_view::npos) place.FailHeader();
  text = text.substr(1, end - 1);
  std::vector<std::size_t> shape;
  while (true) {
    const std::size_t digit = text.find_first_not_of(" ,");
    if (digit == std::string_view::npos) return shape;
    std::size_t size = 0;
    const auto [rest, error] = std::from_chars(text.data() + digit, text.data() + text.size(), size);
    if (error != std::errc()) place.FailHeader();
    shape.push_back(size);
    text = text.substr(static_cast<std::size_t>(rest - text.data()));
  }
}

Header ParseHeader(const std::string& bytes, const Place& place) {
  constexpr std::size_t kVersionAt = 6;
  constexpr std::size_t kLengthAt = 8;
  if (bytes.size() < kLengthAt + 4 || !bytes.starts_with(kMagic)) place.FailHeader();
  const bool long_length = bytes[kVersionAt] >= 2;
  const std::size_t length_bytes = long_length ? 4 : 2;
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i) {
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[kLengthAt + i])) << (8 * i);
  }
  Header header;
  header.data_offset = kLengthAt + length_bytes + length;
  if (header.data_offset > bytes.size()) place.FailHeader();
  const std::string_view text(&bytes[kLengthAt + length_bytes], length);
  const std::string_view descr = After(text, "descr", place);
  if (descr.front() != '\'' && descr.front() != '"') {
    place.Fail("an array of numbers or text", "an array of records", "save its fields as arrays of their own");
  }
  header.descr = std::string(descr.substr(1, descr.find(descr.front(), 1) - 1));
  header.fortran_order = After(text, "fortran_order", place).starts_with("True");
  header.shape = ParseShape(After(text, "shape", place), place);
  return header;
}

/// The number of values, after checking that they take exactly `available` bytes.
std::size_t CheckedCount(const Header& header, std::size_t item_bytes, std::size_t available, const Place& place) {
  std::size_t count = 1;
  bool fits = true;
  for (const std::size_t size : header.shape) {
    fits = fits && (size == 0 || count <= available / size);
    count *= size;
  }
  if (!fits || count * item_bytes != available) {
    place.Fail(fmt::format("{} bytes per value for shape ({})", item_bytes, fmt::join(header.shape, ", ")),
               fmt::format("{} bytes", available), "the array is cut short or damaged; save it again");
  }
  return count;
}

/// Reorders values that are stored column by column.
template <typename T>
std::vector<T> ToRowMajor(const std::vector<T>& values, const std::vector<std::size_t>& shape) {
  std::vector<T> result(values.size());
  std::vector<std::size_t> index(shape.size(), 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::size_t source = 0;
    for (std::size_t d = shape.size(); d-- > 0;) source = source * shape[d] + index[d];
    result[i] = values[source];
    for (std::size_t d = shape.size(); d-- > 0;) {
      if (++index[d] < shape[d]) break;
      index[d] = 0;
    }
  }
  return result;
}

std::vector<std::string> DecodeTexts(const char* data, std::size_t count, std::size_t width, bool wide) {
  std::vector<std::string> texts(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < width; ++c) {
      std::uint32_t character = 0;
      const std::size_t at = i * width + c;
      std::memcpy(&character, data + (wide ? 4 * at : at), wide ? 4 : 1);
      if (character == 0) break;
      if (wide) AppendUtf8(character, texts[i]);
      if (!wide) texts[i] += static_cast<char>(character);
    }
  }
  return texts;
}

template <typename T>
std::vector<T> CopyValues(const std::string& bytes, const Header& header, const Place& place) {
  const std::size_t available = bytes.size() - header.data_offset;
  std::vector<T> values(CheckedCount(header, sizeof(T), available, place));
  if (!values.empty()) std::memcpy(values.data(), &bytes[header.data_offset], available);
  return header.fortran_order ? ToRowMajor(values, header.shape) : values;
}

/// Texts of width 0 take no bytes, so only the shape says how many there are.
std::vector<std::string> EmptyTexts(const Header& header, std::size_t available, const Place& place) {
  constexpr std::size_t kMaxCount = 1 << 24;
  std::size_t count = 1;
  for (const std::size_t size : header.shape) {
    if (size > 0 && count > kMaxCount / size) place.FailHeader();
    count *= size;
  }
  if (available != 0) place.FailHeader();
  return std::vector<std::string>(count);
}

std::vector<std::string> CopyTexts(const std::string& bytes, const Header& header, const Place& place) {
  const bool wide = header.descr[1] == 'U';
  std::size_t width = 0;
  const char* end = header.descr.data() + header.descr.size();
  constexpr std::size_t kMaxWidth = 1 << 20;
  if (std::from_chars(header.descr.data() + 2, end, width).ptr != end || width > kMaxWidth) place.FailHeader();
  const std::size_t available = bytes.size() - header.data_offset;
  if (width == 0) return EmptyTexts(header, available, place);
  const std::size_t count = CheckedCount(header, (wide ? 4 : 1) * width, available, place);
  std::vector<std::string> texts = DecodeTexts(bytes.data() + header.data_offset, count, width, wide);
  return header.fortran_order ? ToRowMajor(texts, header.shape) : texts;
}

}  // namespace

std::string MakeHeader(const std::string& descr, const std::vector<std::size_t>& shape) {
  constexpr std::size_t kPreambleBytes = 10;
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}", descr,
                                 fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  const std::size_t used = kPreambleBytes + text.size() + 1;
  text.append((kAlignment - used % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header(kMagic);
  header += {'\x01', '\x00', static_cast<char>(text.size() & 0xFF), static_cast<char>(text.size() >> 8)};
  return header + text;
}

std::string EncodeTexts(const std::vector<std::string>& texts, std::size_t* width) {
  std::vector<std::u32string> characters;
  *width = 1;  // NumPy has no text of width 0
  for (const std::string& text : texts) {
    characters.push_back(FromUtf8(text));
    *width = std::max(*width, characters.back().size());
  }
  std::string bytes(texts.size() * *width * sizeof(char32_t), '\0');
  for (std::size_t i = 0; i < characters.size(); ++i) {
    std::memcpy(&bytes[i * *width * sizeof(char32_t)], characters[i].data(), characters[i].size() * sizeof(char32_t));
  }
  return bytes;
}

NpyArray Parse(const std::string& bytes, const std::string& file, const std::string& name) {
  const Place place{file, name};
  const Header header = ParseHeader(bytes, place);
  const std::string& descr = header.descr;
  NpyArray array;
  array.shape = header.shape;
  if (descr == "<f4") {
    array.values = CopyValues<float>(bytes, header, place);
  } else if (descr == "<f8") {
    array.values = CopyValues<double>(bytes, header, place);
  } else if (descr == "<i4") {
    array.values = CopyValues<std::int32_t>(bytes, header, place);
  } else if (descr == "<i8") {
    array.values = CopyValues<std::int64_t>(bytes, header, place);
  } else if (descr.starts_with("<U") || descr.starts_with("|S")) {
    array.values = CopyTexts(bytes, header, place);
  } else if (descr.find('O') != std::string::npos) {
    place.Fail("an array of numbers or text", "pickled Python objects",
               "save the numbers as an array of their own: reading pickles can execute code");
  } else {
    place.Fail("float32, float64, int32, int64 or text, little-endian", '\'' + descr + '\'',
               "convert it with astype('float32') before saving");
  }
  return array;
}

std::string ParsePickle(const std::string& bytes, const std::string& file, const std::string& name) {
  const Place place{file, name};
  const Header header = ParseHeader(bytes, place);
  if (header.descr.find('O') == std::string::npos) {
    place.Fail("Python objects", fmt::format("an array of '{}'", header.descr));
  }
  return bytes.substr(header.data_offset);
}

}  // namespace canonpose::npy
