// Arrays, types and single numbers as NumPy 1 and 2 write them into a pickle.
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/data/codecs/pickle_node.h"
#include "canonpose/data/codecs/utf8.h"

namespace canonpose::pickle {
namespace {

constexpr std::array<std::string_view, 11> kKnownNames = {"numpy.core.multiarray._reconstruct",
                                                          "numpy._core.multiarray._reconstruct",
                                                          "numpy.core.multiarray.scalar",
                                                          "numpy._core.multiarray.scalar",
                                                          "numpy.core.numeric._frombuffer",
                                                          "numpy._core.numeric._frombuffer",
                                                          "numpy.ndarray",
                                                          "numpy.dtype",
                                                          "_codecs.encode",
                                                          "__builtin__.bytes",
                                                          "builtins.bytes"};

bool IsText(const Node& node) { return node.kind == Kind::kText || node.kind == Kind::kBytes; }
bool IsType(const Node& node) { return node.stage == Node::Stage::kElements; }

/// "f4", "<f8", "i8", "O8", "b1": a letter, the number of bytes of an element, and possibly their order.
ElementType ParseType(std::string_view text, const Where& where) {
  ElementType type;
  if (!text.empty() && std::string_view("<>|=").find(text.front()) != std::string_view::npos) {
    type.big_endian = text.front() == '>';
    text.remove_prefix(1);
  }
  if (text.empty()) where.FailDamaged("a type of array without a name");
  type.letter = text.front();
  for (const char digit : text.substr(1)) {
    if (digit < '0' || digit > '9' || type.bytes > 1'000'000) {
      where.FailDamaged(fmt::format("the type of array '{}'", text.substr(0, 20)));
    }
    type.bytes = 10 * type.bytes + static_cast<std::size_t>(digit - '0');
  }
  if (type.letter == 'U') type.bytes *= 4;
  return type;
}

std::vector<std::size_t> ParseShape(const Node& node, const Where& where) {
  std::vector<std::size_t> shape;
  if (node.kind == Kind::kInteger && node.integer >= 0) return {static_cast<std::size_t>(node.integer)};
  constexpr std::size_t kMaxDimensions = 32;
  if (node.kind != Kind::kTuple || node.items.size() > kMaxDimensions) where.FailDamaged("an array without its shape");
  for (const Node* size : node.items) {
    if (size->kind != Kind::kInteger || size->integer < 0) where.FailDamaged("an array whose shape is not numbers");
    shape.push_back(static_cast<std::size_t>(size->integer));
  }
  return shape;
}

/// Gives the array its data after checking their number against the shape.
void Fill(Node& array, std::vector<std::size_t> shape, const ElementType& type, bool column_major, const Node& data,
          const Where& where) {
  const bool is_objects = type.letter == 'O';
  const bool has_kind = is_objects ? data.kind == Kind::kList : IsText(data);
  if (!has_kind) where.FailDamaged(fmt::format("an array of '{}' without its values", type.Name()));
  const std::size_t available = is_objects ? data.items.size() : data.text.size();
  std::size_t count = 1;
  bool fits = true;
  for (const std::size_t size : shape) {
    fits = fits && (size == 0 || count <= available / size);
    count *= size;
  }
  if (!fits || count * (is_objects ? 1 : type.bytes) != available) {
    where.FailDamaged(fmt::format("{} {} for an array ({}) of '{}'", available, is_objects ? "objects" : "bytes",
                                  fmt::join(shape, ", "), type.Name()));
  }
  where.Copied(data.items.size() * sizeof(Node*));
  array.shape = std::move(shape);
  array.type = type;
  array.column_major = column_major;
  array.items = data.items;
  array.data = &data.text;
  array.stage = Node::Stage::kDone;
}

bool IsTrue(const Node& node) { return (node.kind == Kind::kBool || node.kind == Kind::kInteger) && node.integer != 0; }

/// A single number: its type and its bytes.
Node* Scalar(Storage& storage, const Node& type_node, const Node& bytes, const Where& where) {
  const ElementType& type = type_node.type;
  if (!type.IsNumber() || !IsText(bytes) || bytes.text.size() != type.bytes) {
    where.FailDamaged(fmt::format("a value of type '{}' that is not a number", type.Name()));
  }
  Node array;
  array.kind = Kind::kArray;
  array.type = type;
  array.data = &bytes.text;
  const double value = Value(nullptr, &array, "").ToNumbers().values.front();
  const bool is_real = type.letter == 'f';
  Node* const number = storage.New(is_real ? Kind::kReal : type.letter == 'b' ? Kind::kBool : Kind::kInteger);
  number->real = value;
  if (!is_real) {
    // A double cannot represent every 8-byte whole number.
    std::memcpy(&number->integer, bytes.text.data(), type.bytes);
    const bool is_negative = type.letter == 'i' && value < 0.0;
    if (is_negative && type.bytes < 8)
      number->integer |= static_cast<std::int64_t>(~std::uint64_t{0} << (8 * type.bytes));
  }
  return number;
}

Node* Encode(Storage& storage, const std::vector<Node*>& arguments, const Where& where) {
  const bool is_latin = arguments.size() == 2 && arguments[0]->kind == Kind::kText && IsText(*arguments[1]) &&
                        (arguments[1]->text == "latin1" || arguments[1]->text == "latin-1");
  if (!is_latin) where.FailDamaged("_codecs.encode of something other than a text to latin1");
  Node* const bytes = storage.New(Kind::kBytes);
  for (const char32_t character : FromUtf8(arguments[0]->text)) {
    if (character > 0xFF) where.FailDamaged("bytes beyond 255");
    bytes->text += static_cast<char>(character);
  }
  where.Copied(bytes->text.size());
  return bytes;
}

}  // namespace

std::string ElementType::Name() const {
  const char order = big_endian ? '>' : bytes > 1 && letter != 'O' ? '<' : '|';
  return fmt::format("{}{}{}", order, letter, letter == 'U' ? bytes / 4 : bytes);
}

bool ElementType::IsNumber() const {
  if (big_endian) return false;
  const bool is_whole = bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8;
  return (letter == 'f' && is_whole && bytes > 1) || ((letter == 'i' || letter == 'u') && is_whole) ||
         (letter == 'b' && bytes == 1);
}

bool IsKnownName(std::string_view name) {
  return std::find(kKnownNames.begin(), kKnownNames.end(), name) != kKnownNames.end();
}

Node* Call(Storage& storage, const Node& function, const Node& arguments, const Where& where) {
  const std::string& name = function.text;
  const std::vector<Node*>& given = arguments.items;
  if (name.ends_with("._reconstruct") && given.size() == 3 && given[0]->text == "numpy.ndarray") {
    Node* const array = storage.New(Kind::kArray);
    array->stage = Node::Stage::kBlank;
    return array;
  }
  if (name == "numpy.dtype" && !given.empty() && IsText(*given[0])) {
    Node* const type = storage.New(Kind::kNone);
    type->stage = Node::Stage::kElements;
    type->type = ParseType(given[0]->text, where);
    return type;
  }
  if (name.ends_with("._frombuffer") && given.size() == 4 && IsType(*given[1]) && IsText(*given[3])) {
    Node* const array = storage.New(Kind::kArray);
    Fill(*array, ParseShape(*given[2], where), given[1]->type, given[3]->text == "F", *given[0], where);
    return array;
  }
  if (name.ends_with(".scalar") && given.size() == 2 && IsType(*given[0])) {
    return Scalar(storage, *given[0], *given[1], where);
  }
  if (name == "_codecs.encode") return Encode(storage, given, where);
  if (name.ends_with(".bytes") && given.empty()) return storage.New(Kind::kBytes);
  where.FailDamaged(fmt::format("a call of {} that NumPy does not write", name));
}

void Build(Node& target, const Node& state, const Where& where) {
  const std::vector<Node*>& parts = state.items;
  if (state.kind == Kind::kTuple && IsType(target) && parts.size() >= 2 && IsText(*parts[1])) {
    if (parts[1]->text == ">") target.type.big_endian = true;
    return;
  }
  const bool is_array = state.kind == Kind::kTuple && target.stage == Node::Stage::kBlank && parts.size() == 5;
  if (!is_array || !IsType(*parts[2])) where.FailDamaged("a state for a value that has none");
  Fill(target, ParseShape(*parts[1], where), parts[2]->type, IsTrue(*parts[3]), *parts[4], where);
}

}  // namespace canonpose::pickle
