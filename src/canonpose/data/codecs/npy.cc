#include "canonpose/data/codecs/npy.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/utf8.h"

namespace canonpose::npy {

struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t data_offset = 0;
};

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied as they are, little-endian");

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;

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
std::vector<T> CopyValues(std::string_view data, const Header& header, const Place& place) {
  std::vector<T> values(CheckedCount(header, sizeof(T), data.size(), place));
  if (!values.empty()) std::memcpy(values.data(), data.data(), data.size());
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

std::vector<std::string> CopyTexts(std::string_view data, const Header& header, const Place& place) {
  const bool wide = header.descr[1] == 'U';
  std::size_t width = 0;
  const char* end = header.descr.data() + header.descr.size();
  constexpr std::size_t kMaxWidth = 1 << 20;
  if (std::from_chars(header.descr.data() + 2, end, width).ptr != end || width > kMaxWidth) place.FailHeader();
  if (width == 0) return EmptyTexts(header, data.size(), place);
  const std::size_t count = CheckedCount(header, (wide ? 4 : 1) * width, data.size(), place);
  std::vector<std::string> texts = DecodeTexts(data.data(), count, width, wide);
  return header.fortran_order ? ToRowMajor(texts, header.shape) : texts;
}

bool IsText(const std::string& descr) { return descr.starts_with("<U") || descr.starts_with("|S"); }

[[noreturn]] void FailType(const std::string& descr, const Place& place) {
  if (descr.find('O') != std::string::npos) {
    place.Fail("an array of numbers or text", "pickled Python objects",
               "save the numbers as an array of their own: reading pickles can execute code");
  }
  place.Fail("float32, float64, int32, int64 or text, little-endian", '\'' + descr + '\'',
             "convert it with astype('float32') before saving");
}

/// The array of which `data` are the values.
NpyArray Decode(const Header& header, std::string_view data, const Place& place) {
  const std::string& descr = header.descr;
  NpyArray array;
  array.shape = header.shape;
  if (descr == "<f4") {
    array.values = CopyValues<float>(data, header, place);
  } else if (descr == "<f8") {
    array.values = CopyValues<double>(data, header, place);
  } else if (descr == "<i4") {
    array.values = CopyValues<std::int32_t>(data, header, place);
  } else if (descr == "<i8") {
    array.values = CopyValues<std::int64_t>(data, header, place);
  } else if (IsText(descr)) {
    array.values = CopyTexts(data, header, place);
  } else {
    FailType(descr, place);
  }
  return array;
}

/// Bytes of one number; 0 where the values are no numbers.
std::size_t NumberBytes(const std::string& descr) {
  if (descr == "<f4" || descr == "<i4") return 4;
  return descr == "<f8" || descr == "<i8" ? 8 : 0;
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
  return Decode(header, std::string_view(bytes).substr(header.data_offset), place);
}

struct FileReader::State {
  std::string file;
  std::string name;
  std::ifstream stream;
  std::size_t data_bytes = 0;
  Header header;

  [[nodiscard]] Place place() const { return {file, name}; }

  std::string Read(std::size_t offset, std::size_t count) {
    std::string bytes(count, '\0');
    stream.clear();
    stream.seekg(static_cast<std::streamoff>(offset));
    stream.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!stream) place().Fail(fmt::format("{} bytes from byte {}", count, offset), "a file that can't be read there");
    return bytes;
  }
};

FileReader::FileReader(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
  // Headers of version 1.0 end within this; those of later versions, which may be longer, are as short in practice.
  constexpr std::size_t kMostHeaderBytes = 10 + 0xFFFF;
  state_->file = path.string();
  state_->name = path.filename().string();
  state_->stream.open(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!state_->stream || error) {
    ThrowBadInput({state_->file, "", "a file that can be read", error ? error.message() : "one that can't be opened",
                   "check the path"});
  }
  const Place place = state_->place();
  state_->header = ParseHeader(state_->Read(0, std::min<std::size_t>(size, kMostHeaderBytes)), place);
  state_->data_bytes = size - state_->header.data_offset;
  const std::size_t item_bytes = NumberBytes(state_->header.descr);
  if (item_bytes == 0 && !IsText(state_->header.descr)) FailType(state_->header.descr, place);
  if (item_bytes > 0) CheckedCount(state_->header, item_bytes, state_->data_bytes, place);
}

FileReader::~FileReader() = default;

const std::vector<std::size_t>& FileReader::shape() const { return state_->header.shape; }

bool FileReader::has_numbers() const { return NumberBytes(state_->header.descr) > 0; }

NpyArray FileReader::ReadPart(std::size_t index) const {
  const Header& whole = state_->header;
  const std::size_t item_bytes = NumberBytes(whole.descr);
  CANONPOSE_CHECK(item_bytes > 0 && !whole.shape.empty() && index < whole.shape[0], "part {} of {}", index,
                  whole.descr);
  const Place place = state_->place();
  Header part = whole;
  part.shape.erase(part.shape.begin());
  const std::size_t bytes = state_->data_bytes / whole.shape[0];
  if (!whole.fortran_order) return Decode(part, state_->Read(whole.data_offset + index * bytes, bytes), place);
  // The values of a part are apart from each other, every `whole.shape[0]`-th of all.
  const std::string all = state_->Read(whole.data_offset, state_->data_bytes);
  std::string values;
  values.reserve(bytes);
  for (std::size_t at = index * item_bytes; at < all.size(); at += whole.shape[0] * item_bytes)
    values.append(all, at, item_bytes);
  return Decode(part, values, place);
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
