#include "canonpose/skeleton/joint_names.h"

#include <cctype>
#include <map>
#include <set>
#include <string_view>

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

}  // namespace

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
