// Names for the values of enums, one table per enum: the words of command lines, files and messages.
//
//   enum class Ray { kOff, kRoot };
//   template <>
//   inline constexpr std::array kEnumNames<Ray>{EnumName{Ray::kOff, "off", "leave the pose as it is"},
//                                               EnumName{Ray::kRoot, "root", "look straight at the root"}};
//
//   ToString(Ray::kRoot)    // "root"
//   ParseEnum<Ray>("off")   // Ray::kOff; nothing for an unknown word
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace canonpose {

template <typename Enum>
struct EnumName {
  Enum value;
  const char* name;
  const char* meaning = "";  ///< for help texts; may be empty where the name says it all
};
// Clang before 17 does not deduce these for an aggregate.
template <typename Enum>
EnumName(Enum, const char*) -> EnumName<Enum>;
template <typename Enum>
EnumName(Enum, const char*, const char*) -> EnumName<Enum>;

/// The table of an enum, in the order in which values are listed. Specialise it beside the enum.
template <typename Enum>
inline constexpr std::array<EnumName<Enum>, 0> kEnumNames{};

template <>
inline constexpr std::array kEnumNames<bool>{EnumName{false, "off"}, EnumName{true, "on"}};

template <typename Enum>
concept NamedEnum = !kEnumNames<Enum>.empty();

template <NamedEnum Enum>
constexpr const char* ToString(Enum value) {
  for (const EnumName<Enum>& entry : kEnumNames<Enum>) {
    if (entry.value == value) return entry.name;
  }
  return "unknown";
}

/// Nothing where no value has this name.
template <NamedEnum Enum>
constexpr std::optional<Enum> ParseEnum(std::string_view name) {
  for (const EnumName<Enum>& entry : kEnumNames<Enum>) {
    if (name == entry.name) return entry.value;
  }
  return std::nullopt;
}

/// All names: "off, root".
template <NamedEnum Enum>
std::string JoinEnumNames(std::string_view separator = ", ") {
  std::string joined;
  for (const EnumName<Enum>& entry : kEnumNames<Enum>) {
    if (!joined.empty()) joined += separator;
    joined += entry.name;
  }
  return joined;
}

}  // namespace canonpose
