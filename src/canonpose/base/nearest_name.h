// Finds the name that somebody who mistyped it may have meant.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// The name that `word` was probably meant to be: the only name that starts with it, or the one with the fewest letters
/// missed, added, replaced or swapped with their neighbour, at most one in three. The first one in a tie; nothing where
/// no name is near. Case is ignored.
std::optional<std::string> NearestName(std::string_view word, const std::vector<std::string>& names);

}  // namespace canonpose
