#include <cmath>
#include <cstring>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/pickle_node.h"

namespace canonpose::pickle {
namespace {

/// Half precision of IEEE 754: 5 bits of exponent and 10 of mantissa.
double HalfToDouble(std::uint16_t half) {
  const int exponent = half >> 10 & 0x1F;
  const int mantissa = half & 0x3FF;
  double value = 0.0;
  if (exponent == 0x1F) {
    value = mantissa == 0 ? HUGE_VAL : std::nan("");
  } else {
    value = std::ldexp(exponent == 0 ? mantissa : mantissa + 0x400, (exponent == 0 ? 1 : exponent) - 25);
  }
  return (half & 0x8000) != 0 ? -value : value;
}

template <typename T>
double Element(const char* data) {
  T value;
  std::memcpy(&value, data, sizeof(T));
  return static_cast<double>(value);
}

double ElementAt(const ElementType& type, const char* data) {
  const bool is_signed = type.letter == 'i';
  switch (type.bytes) {
    case 1:
      return is_signed ? Element<std::int8_t>(data) : Element<std::uint8_t>(data);
    case 2: {
      if (type.letter != 'f') return is_signed ? Element<std::int16_t>(data) : Element<std::uint16_t>(data);
      std::uint16_t half = 0;
      std::memcpy(&half, data, sizeof(half));
      return HalfToDouble(half);
    }
    case 4:
      if (type.letter == 'f') return Element<float>(data);
      return is_signed ? Element<std::int32_t>(data) : Element<std::uint32_t>(data);
    default:
      if (type.letter == 'f') return Element<double>(data);
      return is_signed ? Element<std::int64_t>(data) : Element<std::uint64_t>(data);
  }
}

/// The positions in a column-major array of its elements in row-major order.
class ColumnMajorIndex {
 public:
  explicit ColumnMajorIndex(const std::vector<std::size_t>& shape) : shape_(shape), index_(shape.size(), 0) {}
  std::size_t Next() {
    std::size_t at = 0;
    for (std::size_t d = shape_.size(); d-- > 0;) at = at * shape_[d] + index_[d];
    for (std::size_t d = shape_.size(); d-- > 0;) {
      if (++index_[d] < shape_[d]) break;
      index_[d] = 0;
    }
    return at;
  }

 private:
  const std::vector<std::size_t>& shape_;
  std::vector<std::size_t> index_;
};

std::string KeyText(const Node& key) {
  if (key.kind == Kind::kInteger) return fmt::format("{}", key.integer);
  return key.kind == Kind::kText || key.kind == Kind::kBytes ? key.text : "";
}

bool IsKey(const Node& key) {
  return key.kind == Kind::kInteger || key.kind == Kind::kText || key.kind == Kind::kBytes;
}

constexpr std::size_t kLongestShown = 40;

}  // namespace

Value::Value(std::shared_ptr<const Storage> storage, const Node* node, std::string place)
    : storage_(std::move(storage)), node_(node), place_(std::move(place)) {}

Kind Value::kind() const { return node_->kind; }

std::string Value::Describe() const {
  const Node& node = *node_;
  switch (node.kind) {
    case Kind::kBool:
      return node.integer != 0 ? "True" : "False";
    case Kind::kInteger:
      return fmt::format("{}", node.integer);
    case Kind::kReal:
      return fmt::format("{}", node.real);
    case Kind::kText:
      return fmt::format("the text \"{}\"", node.text.substr(0, kLongestShown));
    case Kind::kBytes:
      return fmt::format("{} bytes", node.text.size());
    case Kind::kList:
      return fmt::format("a list of {} values", node.items.size());
    case Kind::kTuple:
      return fmt::format("a tuple of {} values", node.items.size());
    case Kind::kDictionary:
      return fmt::format("a dictionary of {} members", node.members.size());
    case Kind::kArray:
      return fmt::format("an array ({}) of '{}'", fmt::join(node.shape, ", "), node.type.Name());
    case Kind::kNone:
      break;
  }
  return node.stage == Node::Stage::kDone ? "None" : "the name of a type";
}

void Value::Fail(const std::string& expected, const std::string& advice, const std::string& found) const {
  const std::string& outer = storage_->place;
  ThrowBadInput({storage_->file,
                 outer.empty() || place_.empty() ? outer + place_ : fmt::format("{}, {}", outer, place_), expected,
                 found.empty() ? Describe() : found, advice});
}

std::optional<Value> Value::Find(const std::string& key) const {
  if (node_->kind != Kind::kDictionary) Fail("a dictionary");
  // The last one wins, as in Python.
  for (auto member = node_->members.rbegin(); member != node_->members.rend(); ++member) {
    if (!IsKey(*member->first) || KeyText(*member->first) != key) continue;
    return Value(storage_, member->second, fmt::format("{}[\"{}\"]", place_, key));
  }
  return std::nullopt;
}

Value Value::operator[](const std::string& key) const {
  std::optional<Value> value = Find(key);
  if (value) return *value;
  Fail(fmt::format("a member \"{}\"", key), "",
       node_->members.empty() ? "none" : fmt::format("{}", fmt::join(Keys(), ", ")));
}

std::vector<std::string> Value::Keys() const {
  if (node_->kind != Kind::kDictionary) Fail("a dictionary");
  std::vector<std::string> keys;
  std::set<std::string> seen;
  for (const auto& [key, value] : node_->members) {
    if (!IsKey(*key)) Fail("texts or whole numbers as keys", "", Value(storage_, key, "").Describe());
    if (seen.insert(KeyText(*key)).second) keys.push_back(KeyText(*key));
  }
  return keys;
}

std::size_t Value::size() const {
  if (node_->kind == Kind::kList || node_->kind == Kind::kTuple) return node_->items.size();
  if (node_->kind != Kind::kArray || node_->shape.empty()) Fail("a list");
  return node_->shape.front();
}

Value Value::At(std::size_t index) const {
  const bool is_objects = node_->kind == Kind::kArray && node_->type.letter == 'O' && node_->shape.size() == 1;
  if (node_->kind != Kind::kList && node_->kind != Kind::kTuple && !is_objects) Fail("a list");
  if (index >= node_->items.size()) Fail(fmt::format("more than {} values", index));
  return {storage_, node_->items[index], fmt::format("{}[{}]", place_, index)};
}

Value Value::Unwrapped() const {
  const bool is_wrapper = node_->kind == Kind::kArray && node_->type.letter == 'O' && node_->shape.empty();
  return is_wrapper ? Value(storage_, node_->items.front(), place_) : *this;
}

std::string Value::Text() const {
  if (node_->kind != Kind::kText && node_->kind != Kind::kBytes) Fail("a text");
  return node_->text;
}

std::int64_t Value::Integer() const {
  if (node_->kind != Kind::kInteger) Fail("a whole number");
  return node_->integer;
}

bool Value::IsNumbers() const { return node_->kind == Kind::kArray && node_->type.IsNumber(); }

std::vector<std::size_t> Value::Shape() const {
  if (node_->kind != Kind::kArray) Fail("an array");
  return node_->shape;
}

Numbers Value::ToNumbers() const {
  const Node& node = *node_;
  Numbers numbers;
  if (node.kind == Kind::kList || node.kind == Kind::kTuple) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const Node& item = *node.items[i];
      if (item.kind != Kind::kInteger && item.kind != Kind::kReal) At(i).Fail("a number");
      numbers.values.push_back(item.kind == Kind::kReal ? item.real : static_cast<double>(item.integer));
    }
    numbers.shape = {numbers.values.size()};
    return numbers;
  }
  if (!IsNumbers()) {
    const bool is_swapped = node.kind == Kind::kArray && node.type.big_endian;
    Fail("an array of numbers", is_swapped ? "convert it with astype('float32'), little-endian" : "");
  }
  numbers.shape = node.shape;
  numbers.values.resize(node.data->size() / node.type.bytes);
  ColumnMajorIndex index(node.shape);
  for (std::size_t i = 0; i < numbers.values.size(); ++i) {
    const std::size_t from = node.column_major ? index.Next() : i;
    numbers.values[i] = ElementAt(node.type, node.data->data() + from * node.type.bytes);
  }
  return numbers;
}

std::vector<std::int64_t> Value::Integers() const {
  const Numbers numbers = ToNumbers();
  if (numbers.shape.size() != 1) Fail("one row of whole numbers");
  std::vector<std::int64_t> integers;
  for (const double value : numbers.values) {
    constexpr double kLargestExact = 9007199254740992.0;
    if (!(std::abs(value) <= kLargestExact) || value != std::trunc(value)) {
      Fail("whole numbers", "", fmt::format("{}", value));
    }
    integers.push_back(static_cast<std::int64_t>(value));
  }
  return integers;
}

}  // namespace canonpose::pickle
