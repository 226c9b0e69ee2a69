#include "canonpose/skeleton/joint_names.h"

#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "canonpose/base/names.h"

namespace canonpose {
namespace {

constexpr double kShareWithPrefix = 0.8;
constexpr std::size_t kFewestNames = 4;
/// Shorter ones may be sides ("l_", "R").
constexpr std::size_t kShortestPrefix = 3;

/// Whether a word of the name begins at `at`.
bool BeginsWord(std::string_view name, std::size_t at) {
  const auto before = static_cast<unsigned char>(name[at - 1]);
  const auto here = static_cast<unsigned char>(name[at]);
  if (std::isalnum(here) == 0) return false;
  return std::isalnum(before) == 0 || (std::isupper(here) != 0 && std::isupper(before) == 0);
}

std::string CommonPrefix(const std::vector<std::string>& names) {
  if (names.size() < kFewestNames) return "";
  std::map<std::string, std::size_t> counts;
  for (const std::string& name : names) {
    for (std::size_t at = kShortestPrefix; at < name.size(); ++at) {
      if (BeginsWord(name, at)) ++counts[name.substr(0, at)];
    }
  }
  std::string longest;
  for (const auto& [prefix, count] : counts) {
    const bool is_common = static_cast<double>(count) >= kShareWithPrefix * static_cast<double>(names.size());
    if (is_common && prefix.size() > longest.size()) longest = prefix;
  }
  return longest;
}

bool AreDifferent(const std::vector<std::string>& names) {
  return std::set<std::string>(names.begin(), names.end()).size() == names.size();
}

bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool IsUpper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// The word in the case of the text that it replaces: "right" for "LEFT" is "RIGHT".
std::string InCaseOf(std::string_view text, std::string word) {
  for (std::size_t i = 0; i < word.size(); ++i) {
    const bool is_upper = i == 0 ? IsUpper(text[0]) : IsUpper(text[0]) && IsUpper(text[1]);
    if (is_upper) word[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[i])));
  }
  return word;
}

/// Whether the letter at `at` stands for itself: "L_ear", "ear.L", "earL", "LEar", "L1".
bool IsWordOfOneLetter(std::string_view name, std::size_t at) {
  const bool begins = at == 0 || !IsLetter(name[at - 1]) || (IsUpper(name[at]) && !IsUpper(name[at - 1]));
  const bool ends = at + 1 == name.size() || !IsLetter(name[at + 1]) || IsUpper(name[at + 1]);
  return begins && ends;
}

/// What the partner of a joint may be called, the likeliest first.
std::vector<std::string> OtherSides(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kWords{
      {{"left", "right"}, {"right", "left"}}};
  std::vector<std::string> others;
  for (const auto& [word, other] : kWords) {
    const std::string lower = LowerCase(name);
    for (std::size_t at = lower.find(word); at != std::string::npos; at = lower.find(word, at + 1)) {
      const std::string text = name.substr(at, word.size());
      others.push_back(name.substr(0, at) + InCaseOf(text, std::string(other)) + name.substr(at + word.size()));
    }
  }
  static constexpr std::string_view kLetters = "LRlr";
  static constexpr std::string_view kOthers = "RLrl";
  const auto swap_letter = [&](std::size_t at) {
    const std::size_t letter = kLetters.find(name[at]);
    if (letter == std::string_view::npos) return;
    others.push_back(name);
    others.back()[at] = kOthers[letter];
  };
  for (std::size_t at = 0; at < name.size(); ++at) {
    if (IsWordOfOneLetter(name, at)) swap_letter(at);
  }
  if (!name.empty()) swap_letter(0);  // "lear" and "rear"
  return others;
}

std::optional<int> IndexOf(const std::vector<std::string>& names, const std::string& name) {
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (SameName(names[j], name)) return static_cast<int>(j);
  }
  return std::nullopt;
}

}  // namespace

std::vector<int> SidePartners(const std::vector<std::string>& names) {
  std::vector<int> partners(names.size(), -1);
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (partners[j] >= 0) continue;
    partners[j] = static_cast<int>(j);
    for (const std::string& other : OtherSides(names[j])) {
      const std::optional<int> partner = IndexOf(names, other);
      if (!partner || *partner <= static_cast<int>(j) || partners[static_cast<std::size_t>(*partner)] >= 0) continue;
      partners[j] = *partner;
      partners[static_cast<std::size_t>(*partner)] = static_cast<int>(j);
      break;
    }
  }
  return partners;
}

std::vector<std::string> WithoutPrefix(const std::vector<std::string>& names) {
  std::vector<std::string> plain;
  plain.reserve(names.size());
  for (const std::string& name : names) {
    const std::size_t separator = name.find_last_of(":|");
    plain.push_back(separator == std::string::npos || separator + 1 == name.size() ? name : name.substr(separator + 1));
  }
  if (!AreDifferent(plain)) plain = names;
  const std::string prefix = CommonPrefix(plain);
  if (prefix.empty()) return plain;
  std::vector<std::string> shorter;
  shorter.reserve(plain.size());
  for (const std::string& name : plain) {
    const bool has_prefix = name.size() > prefix.size() && name.starts_with(prefix);
    shorter.push_back(has_prefix ? name.substr(prefix.size()) : name);
  }
  return AreDifferent(shorter) ? shorter : plain;
}

}  // namespace canonpose
