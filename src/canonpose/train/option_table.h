// Tables of options: one row per field of an options struct, from which parsing, validation, JSON, help and
// documentation are made.
//
//   constexpr std::tuple kTable{
//       Number("width", &Options::width, Range::Between(1, 65536), "Width of the network's layers"),
//       Choice("mirror", &Options::mirror, "Which of the two mirror images to keep"),
//       NotInResults(Number("threads", &Options::threads, Range::AtLeast(0), "Threads to compute with"))};
//   static_assert(CoversAllFields<Options>(kTable));
//
// Included by the sources that define a table; the text in option_description.h is for everyone else.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/decimal_comma.h"
#include "canonpose/base/enum_names.h"
#include "canonpose/base/error.h"
#include "canonpose/train/option_description.h"

namespace canonpose {

/// The values that a number may have; all are finite.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool excludes_min = false;

  static constexpr Range AtLeast(double min) { return {min}; }
  static constexpr Range MoreThan(double min) { return {min, std::numeric_limits<double>::infinity(), true}; }
  static constexpr Range Between(double min, double max) { return {min, max}; }

  [[nodiscard]] bool Contains(double value) const {
    return std::isfinite(value) && (excludes_min ? value > min : value >= min) && value <= max;
  }
  /// "1 or more", "more than 0", "0 to 1", "more than 0, at most 1"
  [[nodiscard]] std::string ToString() const;
};

/// One field of `Options`. Its default is that of a default-constructed `Options`.
template <typename Options, typename Value>
struct OptionRow {
  const char* name;  ///< of the field; also its key in JSON
  Value Options::*field;
  Range range;        ///< of numbers
  const char* words;  ///< of texts: the values they may have, for the reader
  const char* help;   ///< one sentence without a full stop, or several with them; field names in backquotes
  bool changes_results = true;
};

template <typename Options, typename Value>
constexpr OptionRow<Options, Value> Number(const char* name, Value Options::*field, Range range, const char* help) {
  static_assert(std::is_arithmetic_v<Value>);
  return {name, field, range, "", help};
}

/// A value of an enum, or a switch, with names in kEnumNames.
template <typename Options, NamedEnum Value>
constexpr OptionRow<Options, Value> Choice(const char* name, Value Options::*field, const char* help) {
  return {name, field, {}, "", help};
}

/// A text that is checked elsewhere.
template <typename Options>
constexpr OptionRow<Options, std::string> Text(const char* name, std::string Options::*field, const char* words,
                                               const char* help) {
  return {name, field, {}, words, help};
}

/// Marks an option about the machine, which a resumed run may change.
template <typename Row>
constexpr Row NotInResults(Row row) {
  row.changes_results = false;
  return row;
}

template <typename Table, typename Visit>
void ForEachRow(const Table& table, Visit&& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, table);
}

namespace internal {

struct AnyValue {
  template <typename Value>
  constexpr operator Value() const;  // NOLINT: implicit on purpose; only its type is used
};

/// The number of fields of an aggregate: of the values it can be made from at most.
template <typename Options, typename... Values>
consteval std::size_t FieldCount() {
  if constexpr (requires { Options{Values{}..., AnyValue{}}; }) {
    return FieldCount<Options, Values..., AnyValue>();
  } else {
    return sizeof...(Values);
  }
}

/// "a whole number, 1 to 65536", "one of off, root"
template <typename Options, typename Value>
std::string ExpectedValues(const OptionRow<Options, Value>& row) {
  if constexpr (NamedEnum<Value>) {
    return "one of " + JoinEnumNames<Value>();
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return fmt::format("a {}, {}", std::is_integral_v<Value> ? "whole number" : "number", row.range.ToString());
  } else {
    return row.words;
  }
}

template <typename Options, typename Value>
[[noreturn]] void ThrowUnexpected(const OptionRow<Options, Value>& row, const std::string& found) {
  ThrowInvalidArgument("`{}`: expected {}, found \"{}\"{}", row.name, ExpectedValues(row), found,
                       std::is_arithmetic_v<Value> ? HintAtDecimalComma(found) : "");
}

template <typename Options, typename Value>
std::string ValueText(const OptionRow<Options, Value>& row, const Options& options) {
  if constexpr (NamedEnum<Value>) {
    return ToString(options.*row.field);
  } else {
    return fmt::format("{}", options.*row.field);
  }
}

template <typename Options, typename Value>
void ParseValue(const OptionRow<Options, Value>& row, const std::string& text, Options& options) {
  if constexpr (NamedEnum<Value>) {
    const std::optional<Value> value = ParseEnum<Value>(text);
    if (!value) ThrowUnexpected(row, text);
    options.*row.field = *value;
  } else if constexpr (std::is_arithmetic_v<Value>) {
    Value value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) ThrowUnexpected(row, text);
    options.*row.field = value;
  } else {
    options.*row.field = text;
  }
}

template <typename Options, typename Value>
std::string MeaningsOf(const OptionRow<Options, Value>&) {
  std::string text;
  if constexpr (NamedEnum<Value>) {
    for (const EnumName<Value>& entry : kEnumNames<Value>) {
      if (*entry.meaning == '\0') continue;
      text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", entry.name, entry.meaning);
    }
  }
  return text;
}

}  // namespace internal

/// Whether a table has as many rows as its struct has fields.
template <typename Options, typename Table>
consteval bool CoversAllFields(const Table&) {
  return std::tuple_size_v<Table> == internal::FieldCount<Options>();
}

template <typename Table>
bool HasRow(const Table& table, const std::string& name) {
  bool found = false;
  ForEachRow(table, [&](const auto& row) { found = found || name == row.name; });
  return found;
}

/// Sets a field by name. Throws Error(kInvalidArgument) for an unknown name, listing the known ones, or a text that is
/// not such a value; ranges are left to RequireRanges().
template <typename Options, typename Table>
void SetField(const Table& table, const std::string& name, const std::string& text, Options& options) {
  bool found = false;
  std::string known;
  ForEachRow(table, [&](const auto& row) {
    known += (known.empty() ? "" : ", ") + std::string(row.name);
    if (name != row.name) return;
    internal::ParseValue(row, text, options);
    found = true;
  });
  if (!found) ThrowInvalidArgument("there is no option \"{}\"; the options are {}", name, known);
}

/// The text of a field, as SetField() takes it; empty for an unknown name.
template <typename Options, typename Table>
std::string GetField(const Table& table, const std::string& name, const Options& options) {
  std::string text;
  ForEachRow(table, [&](const auto& row) {
    if (name == row.name) text = internal::ValueText(row, options);
  });
  return text;
}

/// Throws Error(kInvalidArgument) naming the first number that is out of its range.
template <typename Options, typename Table>
void RequireRanges(const Table& table, const Options& options) {
  ForEachRow(table, [&](const auto& row) {
    using Value = std::remove_cvref_t<decltype(options.*row.field)>;
    if constexpr (std::is_arithmetic_v<Value> && !NamedEnum<Value>) {
      if (row.range.Contains(static_cast<double>(options.*row.field))) return;
      internal::ThrowUnexpected(row, internal::ValueText(row, options));
    }
  });
}

/// The fields as an object, in the order of the table.
template <typename Options, typename Table>
std::string WriteJson(const Table& table, const Options& options, bool only_what_changes_results) {
  nlohmann::ordered_json json;
  ForEachRow(table, [&](const auto& row) {
    if (only_what_changes_results && !row.changes_results) return;
    if constexpr (NamedEnum<std::remove_cvref_t<decltype(options.*row.field)>>) {
      json[row.name] = ToString(options.*row.field);
    } else {
      json[row.name] = options.*row.field;
    }
  });
  return json.dump();
}

/// Fields that the object does not have keep their defaults. Throws nlohmann's exceptions where it is damaged, and
/// Error(kInvalidArgument) for an unknown word.
template <typename Options, typename Table>
Options ReadJson(const Table& table, const std::string& text) {
  Options options;
  const auto json = nlohmann::ordered_json::parse(text);
  ForEachRow(table, [&](const auto& row) {
    if (!json.contains(row.name)) return;
    if constexpr (NamedEnum<std::remove_cvref_t<decltype(options.*row.field)>>) {
      internal::ParseValue(row, json[row.name].template get<std::string>(), options);
    } else {
      json[row.name].get_to(options.*row.field);
    }
  });
  return options;
}

/// The table as text.
template <typename Options, typename Table>
std::vector<OptionDescription> DescribeTable(const Table& table) {
  const Options defaults;
  std::vector<OptionDescription> descriptions;
  ForEachRow(table, [&](const auto& row) {
    using Value = std::remove_cvref_t<decltype(defaults.*row.field)>;
    OptionDescription description;
    description.name = row.name;
    description.help = row.help;
    description.meanings = internal::MeaningsOf(row);
    description.default_value = internal::ValueText(row, defaults);
    description.changes_results = row.changes_results;
    if constexpr (NamedEnum<Value>) {
      description.values = JoinEnumNames<Value>();
    } else if constexpr (std::is_arithmetic_v<Value>) {
      description.values = row.range.ToString();
    } else {
      description.values = row.words;
    }
    descriptions.push_back(std::move(description));
  });
  return descriptions;
}

}  // namespace canonpose
