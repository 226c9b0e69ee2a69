#include "canonpose/data/codecs/json.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/file_kind.h"

namespace canonpose {
namespace {

using Json = nlohmann::json;

constexpr const char* kNotFiniteAdvice =
    "the file says that the detector failed there; write missing joints as 0 with confidence 0";
/// No pixel coordinate and no length in mm is anywhere near this large.
constexpr double kLargestNumber = 1e9;
/// Lists of keys in messages are cut off here.
constexpr std::size_t kLongestKeys = 120;

bool IsWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
}

/// The number or word at a position.
std::string WordAt(std::string_view text, std::size_t position) {
  std::size_t begin = std::min(position, text.size());
  while (begin > 0 && IsWordCharacter(text[begin - 1])) --begin;
  std::size_t end = std::min(position, text.size());
  while (end < text.size() && IsWordCharacter(text[end])) ++end;
  return std::string(text.substr(begin, std::min<std::size_t>(end - begin, 40)));
}

bool IsNotFinite(std::string word) {
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.erase(0, 1);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word.starts_with("nan") || word == "inf" || word == "infinity";
}

bool IsNaN(const std::string& word) { return IsNotFinite(word) && word.find_first_of("fF") == std::string::npos; }

/// A text in which each NaN outside of strings is replaced by null.
struct WithoutNaN {
  std::string text;
  std::vector<std::size_t> added;  ///< positions in `text` of the bytes that a replacement made it longer by, ascending

  /// Where a position of `text` is in the original.
  [[nodiscard]] std::size_t Original(std::size_t position) const {
    return position - static_cast<std::size_t>(std::lower_bound(added.begin(), added.end(), position) - added.begin());
  }
};

WithoutNaN ReplaceNaN(std::string_view text) {
  WithoutNaN result;
  result.text.reserve(text.size() + text.size() / 16);
  bool is_in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_word =
        !is_in_string && (c == 'N' || c == 'n' || c == '-' || c == '+') && (i == 0 || !IsWordCharacter(text[i - 1]));
    const std::string word = is_word ? WordAt(text, i) : "";
    const std::size_t sign = word.starts_with('-') || word.starts_with('+') ? 1 : 0;
    if (word.size() == sign + 3 && IsNaN(word)) {
      result.text += "null";
      if (sign == 0) result.added.push_back(result.text.size() - 1);
      i += word.size() - 1;
      continue;
    }
    result.text += c;
    if (c == '"') is_in_string = !is_in_string;
    if (c == '\\' && is_in_string && i + 1 < text.size()) result.text += text[++i];
  }
  return result;
}

/// One step of the path to a place in a text: the index in an array, or the key in an object.
struct Step {
  bool is_array = false;
  std::size_t index = 0;
  std::string key;
};

/// "people[0].pose_keypoints_2d[5]": the path to a position in a text, as far as it follows from the text before it.
std::string PathTo(std::string_view text) {
  std::vector<Step> steps;
  std::string last_string;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const std::size_t begin = ++i;
      while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2U : 1U;
      last_string = i <= text.size() ? std::string(text.substr(begin, i - begin)) : "";
    } else if (c == '[' || c == '{') {
      steps.push_back({c == '[', 0, ""});
    } else if ((c == ']' || c == '}') && !steps.empty()) {
      steps.pop_back();
    } else if (c == ',' && !steps.empty()) {
      ++steps.back().index;
    } else if (c == ':' && !steps.empty()) {
      steps.back().key = last_string;
    }
  }
  std::string path;
  for (const Step& step : steps) {
    if (step.is_array) {
      path += fmt::format("[{}]", step.index);
    } else if (!step.key.empty()) {
      path += (path.empty() ? "" : ".") + step.key;
    }
  }
  return path;
}

/// "line 3, column 7 (people[0].pose_keypoints_2d[5])"
std::string PlaceAt(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, std::min(position, text.size()));
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  const std::string path = PathTo(before);
  return fmt::format("line {}, column {}{}", lines + 1, before.size() - line_start + 1,
                     path.empty() ? "" : " (" + path + ")");
}

bool IsBlank(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; });
}

[[noreturn]] void ThrowSyntaxError(const std::string& file, std::string_view text, std::size_t bytes_read) {
  if (IsBlank(text)) ThrowBadInput({file, "", "JSON", "an empty file", "export it again"});
  // The parser counts the end of the text as another byte.
  if (bytes_read > text.size()) {
    ThrowBadInput({file, PlaceAt(text, text.size()), "the rest of the JSON", "the end of the file",
                   "the file was cut off; export or copy it again"});
  }
  const std::size_t position = bytes_read > 0 ? bytes_read - 1 : 0;
  const std::string word = WordAt(text, position);
  if (IsNotFinite(word)) ThrowBadInput({file, PlaceAt(text, position), "a finite number", word, kNotFiniteAdvice});
  const std::string found = word.empty() ? fmt::format("'{}'", text[position]) : fmt::format("'{}'", word);
  const bool is_printable =
      std::all_of(found.begin(), found.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7F; });
  ThrowBadInput({file, PlaceAt(text, position), "JSON", is_printable ? found : "bytes that are not text",
                 "the file is damaged or in another format"});
}

[[noreturn]] void ThrowOverflow(const std::string& file, std::string_view text, const std::string& message) {
  // "... number overflow parsing '1e999'": only here does the parser say what it read.
  const std::size_t end = message.rfind('\'');
  const std::size_t begin = end == std::string::npos || end == 0 ? std::string::npos : message.rfind('\'', end - 1);
  const std::string number = begin == std::string::npos ? "" : message.substr(begin + 1, end - begin - 1);
  const std::size_t position = number.empty() ? std::string_view::npos : text.find(number);
  ThrowBadInput({file, position == std::string_view::npos ? "" : PlaceAt(text, position), "a finite number",
                 number.empty() ? "one too large for any computer number" : number, kNotFiniteAdvice});
}

}  // namespace

JsonValue::JsonValue(std::shared_ptr<const Document> document, const Json* value, std::string place)
    : document_(std::move(document)), value_(value), place_(std::move(place)) {}

JsonValue JsonValue::Load(const std::filesystem::path& path) {
  // A video may be too large to be read as a whole.
  if (const std::string kind = KindOfFile(path); !kind.empty())
    ThrowBadInput({path.string(), "", "JSON", kind, AdviceForKind(kind)});
  const std::string text = ReadFile(path);
  auto document = std::make_shared<Document>();
  document->file = path.string();
  const auto parse = [&](const std::string& valid, const WithoutNaN* without_nan) {
    try {
      document->root = Json::parse(valid);
      return true;
    } catch (const Json::parse_error& error) {
      if (without_nan == nullptr) return false;
      // The parser counts from 1, and the end of the text as another byte.
      const bool is_end = error.byte > valid.size();
      ThrowSyntaxError(document->file, text,
                       is_end ? text.size() + 1 : without_nan->Original(std::max<std::size_t>(error.byte, 1) - 1) + 1);
    } catch (const Json::out_of_range& error) {
      ThrowOverflow(document->file, text, error.what());
    } catch (const Json::exception& error) {
      ThrowBadInput({document->file, "", "JSON", error.what(), "export it again"});
    }
  };
  if (!parse(text, nullptr)) {
    const WithoutNaN without_nan = ReplaceNaN(text);
    parse(without_nan.text, &without_nan);
    document->has_nan = true;
  }
  const Json* root = &document->root;
  return {std::move(document), root, ""};
}

std::optional<JsonValue> JsonValue::Find(const std::string& key) const {
  if (!value_->is_object()) return std::nullopt;
  const auto member = value_->find(key);
  if (member == value_->end() || member->is_null()) return std::nullopt;
  return JsonValue(document_, &*member, place_.empty() ? key : place_ + "." + key);
}

JsonValue JsonValue::operator[](const std::string& key) const {
  if (!value_->is_object()) Fail(fmt::format("an object with {}", key));
  const auto member = value_->find(key);
  if (member == value_->end()) {
    const std::string found = DescribeStructure();
    Fail(fmt::format("an object with {}", key), "", value_->empty() ? found : "one with" + found.substr(14));
  }
  return {document_, &*member, place_.empty() ? key : place_ + "." + key};
}

std::size_t JsonValue::ArraySize() const {
  if (!value_->is_array()) Fail("an array");
  return value_->size();
}

JsonValue JsonValue::At(std::size_t index) const {
  CANONPOSE_CHECK(value_->is_array() && index < value_->size(), "{} at {}", index, place_);
  return {document_, &(*value_)[index], fmt::format("{}[{}]", place_, index)};
}

std::vector<std::string> JsonValue::Keys() const {
  if (!value_->is_object()) Fail("an object");
  std::vector<std::string> keys;
  for (const auto& item : value_->items()) keys.push_back(item.key());
  return keys;
}

double JsonValue::Number() const {
  if (value_->is_string() && IsNotFinite(value_->get<std::string>())) Fail("a finite number", kNotFiniteAdvice);
  if (value_->is_null()) Fail("a number", kNotFiniteAdvice);
  if (!value_->is_number()) Fail("a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) Fail("a finite number", kNotFiniteAdvice, fmt::format("{}", number));
  if (std::abs(number) > kLargestNumber) {
    Fail("a coordinate or a confidence", "no image is that large", fmt::format("{}", number));
  }
  return number;
}

std::int64_t JsonValue::Integer() const {
  if (value_->is_number_integer()) {
    if (value_->is_number_unsigned() && value_->get<std::uint64_t>() > INT64_MAX) Fail("a smaller whole number");
    return value_->get<std::int64_t>();
  }
  const double number = Number();
  if (number != std::floor(number)) Fail("a whole number", "", fmt::format("{}", number));
  return static_cast<std::int64_t>(number);
}

std::vector<double> JsonValue::Numbers() const {
  const std::size_t count = ArraySize();
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Json& element = (*value_)[i];
    // Fast for valid values; At() is only called to get the place for a message.
    const double number = element.is_number() ? element.get<double>() : kLargestNumber * 2.0;
    numbers[i] = std::abs(number) <= kLargestNumber ? number : At(i).Number();
  }
  return numbers;
}

std::vector<double> JsonValue::NumbersOrNaN() const {
  const std::size_t count = ArraySize();
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Json& element = (*value_)[i];
    if (element.is_null() || (element.is_string() && IsNaN(element.get<std::string>()))) {
      numbers[i] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const double number = element.is_number() ? element.get<double>() : kLargestNumber * 2.0;
    numbers[i] = std::abs(number) <= kLargestNumber ? number : At(i).Number();
  }
  return numbers;
}

std::string JsonValue::String() const {
  if (!value_->is_string()) Fail("a string");
  return value_->get<std::string>();
}

std::string JsonValue::Describe() const {
  switch (value_->type()) {
    case Json::value_t::array:
      return value_->size() == 1 ? "an array of 1 value" : fmt::format("an array of {} values", value_->size());
    case Json::value_t::object:
      return "an object";
    case Json::value_t::string: {
      const auto text = value_->get<std::string>();
      return fmt::format("the string \"{}\"", text.size() > 40 ? text.substr(0, 40) + "..." : text);
    }
    case Json::value_t::null:
      return document_->has_nan ? "null or NaN" : "null";
    default:
      return value_->dump();
  }
}

std::string JsonValue::DescribeStructure() const {
  const auto with_keys = [](const Json& object) {
    std::string keys;
    for (const auto& item : object.items()) keys += (keys.empty() ? "" : ", ") + item.key();
    return keys.size() > kLongestKeys ? keys.substr(0, kLongestKeys) + "..." : keys;
  };
  if (value_->is_object()) return value_->empty() ? "an empty object" : "an object with " + with_keys(*value_);
  if (!value_->is_array() || value_->empty() || !value_->front().is_object() || value_->front().empty())
    return Describe();
  return fmt::format("an array of {} object{} with {}", value_->size(), value_->size() == 1 ? "" : "s",
                     with_keys(value_->front()));
}

void JsonValue::Fail(const std::string& expected, const std::string& advice, const std::string& found) const {
  ThrowBadInput({document_->file, place_, expected, found.empty() ? Describe() : found, advice});
}

char FirstCharacter(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) ReadFile(path);  // throws with the system's reason
  char c = 0;
  while (stream.get(c)) {
    // There may be a byte-order mark.
    if (std::isspace(static_cast<unsigned char>(c)) == 0 && static_cast<unsigned char>(c) < 0x80) return c;
  }
  return 0;
}

}  // namespace canonpose
